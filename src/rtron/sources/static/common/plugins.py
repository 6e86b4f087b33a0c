"""Plugins of the workspace that a node of a model loads: run beside the model, in its process."""

from collections.abc import Iterator
from dataclasses import replace

from rtron.sources.code.library_models.common.navigation_plugins import PLUGIN_BASES
from rtron.sources.declaration import LoadedPlugin, NodeSite, ParameterSetting
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.task import InterpretationTask, TaskKind, TaskResult
from rtron.sources.workspace import Plugin, Workspace


def plugin_tasks(part: NodePart, workspace: Workspace) -> Iterator[InterpretationTask]:
    """Yield a task for each plugin that has no model, and whose source is here."""
    for loaded in part.interface.plugins:
        found = _find_plugin(loaded.class_name, workspace)
        if found is not None and found.program is not None and found.program.sources:
            others = (other.type for other in workspace.plugins(found.plugin_class.base))
            yield InterpretationTask(
                kind=TaskKind.PLUGIN,
                sources=found.program.sources,
                class_name=found.plugin_class.type,
                definitions=found.program.definitions,
                other_components=tuple(t for t in others if t != found.plugin_class.type),
                site=_plugin_site(part.node.site, replace(loaded, base=found.plugin_class.base)),
            )


def _find_plugin(name: str, workspace: Workspace) -> Plugin | None:
    """Return a plugin whose base is known; a name may be written with `/` or `::`."""
    spelled = dict.fromkeys((name, name.replace("::", "/"), name.replace("/", "::")))
    found = (workspace.plugin(each, base) for base in PLUGIN_BASES for each in spelled)
    return next(filter(None, found), None)


def _plugin_site(site: NodeSite, loaded: LoadedPlugin) -> NodeSite:
    if site.ros == 1:
        return replace(site, plugin=loaded)
    own = (ParameterSetting(node=site.name, name=name, value=v) for name, v in site.overrides)
    return replace(
        site,
        name=loaded.node,
        args=(),
        remap_rules=(),
        has_launch_name=True,
        has_launch_namespace=True,
        settings=(*site.settings, *own),
        overrides=(),
        loading=None,
        plugin=loaded,
    )


def with_plugin(part: NodePart, task: InterpretationTask, result: TaskResult) -> NodePart:
    """Return the part of a model with what a plugin's source says instead of the note on it."""
    before, its, loaded = part.interface, result.interface, task.site.plugin
    known = {(each.kind, each.name, each.node) for each in before.declarations}
    new = (each for each in its.declarations if (each.kind, each.name, each.node) not in known)
    named = {node.name for node in before.nodes}
    class_name = loaded.class_name if loaded else ""
    interface = replace(
        before,
        nodes=(*before.nodes, *(node for node in its.nodes if node.name not in named)),
        declarations=(*before.declarations, *new),
        runtime_starts=(*before.runtime_starts, *its.runtime_starts),
        unresolved=(
            *(note for note in before.unresolved if note.what.partition(":")[2] != class_name),
            *its.unresolved,
        ),
        parameters=(*before.parameters, *its.parameters),
        frames=(*before.frames, *its.frames),
        frame_uses=(*before.frame_uses, *its.frame_uses),
        plugin_ids=(*before.plugin_ids, *its.plugin_ids),
        mistyped=(*before.mistyped, *its.mistyped),
        last_messages=(*before.last_messages, *its.last_messages),
        message_flows=(*before.message_flows, *its.message_flows),
    )
    return replace(part, interface=interface)

"""Where a node's interface is to be found: in its source, in a model, or nowhere.

A nodelet's loader has two parts: its own process, and the nodelet in its manager's process.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from rtron.sources.declaration import NodeInterface
from rtron.sources.models import Model, ModelCatalog
from rtron.sources.models.common.arguments import positional
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.task import (
    InterpretationTask,
    TaskKind,
    component_task,
    executable_task,
)
from rtron.sources.workspace import Program, ProgramLanguage, Workspace
from rtron.sources.workspace.package_files import is_in_build_files
from rtron.vocabulary import Trust, UnresolvedItem
from rtron.vocabulary.launch import resolve_name

MISSING_PROGRAM = "its package makes no program of this name, nor has an executable file"
_NOT_HERE = "its package is not here: give the folder of its source too"
_NOT_UNDERSTOOD = "the build files of its package name its program in a way that is not understood"
_KINDS = {
    ProgramLanguage.CPP: TaskKind.CPP,
    ProgramLanguage.PYTHON: TaskKind.PYTHON,
    ProgramLanguage.SHELL: TaskKind.SHELL,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class NodePart:
    """Something of `node` that runs in the process of the node `owner`.

    `model` or `task` tells what it declares, or both: then the task tells what its source has
    beside the model. `interface` is there once that is known.
    """

    node: AppNode
    owner: str
    model: Model | None = None
    task: InterpretationTask | None = None
    interface: NodeInterface = field(default_factory=NodeInterface)

    @property
    def is_unread(self) -> bool:
        """Whether neither source nor a model tells all that the node publishes and subscribes."""
        if self.model is not None:
            return self.model.unread
        interface = self.interface
        if interface.declarations:
            return False
        is_source_silent = self.task and not (interface.nodes or interface.runtime_starts)
        return bool(interface.unresolved or is_source_silent)

    def with_missing_note(self, what: str, why: str, missing: str = "") -> "NodePart":
        """Return the part with a note instead of an interface."""
        note = UnresolvedItem(what=what, why=why, missing=missing, evidence=(self.node.evidence,))
        return replace(self, interface=NodeInterface(unresolved=(note,)))


def node_parts(node: AppNode, workspace: Workspace, models: ModelCatalog) -> Iterator[NodePart]:
    """Yield what a node runs: source where it is there, and a model that goes before it."""
    if node.site.ros > 1:
        yield _ros2_part(NodePart(node=node, owner=node.name), workspace, models)
        return
    model = models.node(node.package, node.type)
    part = NodePart(node=node, owner=node.name)
    if model is not None and model.role is NodeRole.NODELET:
        loader = _with_source_or_model(part, workspace.executable(node.package, node.type), model)
        yield from _nodelet_parts(replace(loader, model=model), workspace, models)
        return
    part = _with_source_or_model(part, workspace.executable(node.package, node.type), model)
    is_missing = part.task is None and part.model is None and _lacks_program(node, workspace)
    yield _without_program(part) if is_missing else part


def _lacks_program(node: AppNode, workspace: Workspace) -> bool:
    """Return whether a package of the user's own neither makes nor names a node's program."""
    return (
        workspace.trust(node.package) is Trust.OWN
        and workspace.executable(node.package, node.type) is None
        and not is_in_build_files(workspace.files(node.package), node.type)
    )


def _without_program(part: NodePart) -> NodePart:
    program = f"{part.node.package}/{part.node.type}"
    what = f"node {part.node.name} ({program})"
    return part.with_missing_note(what, MISSING_PROGRAM, program)


def _with_source_or_model(part: NodePart, program: Program | None, model: Model | None) -> NodePart:
    if program is not None and program.language in _KINDS and program.sources:
        kind = _KINDS[program.language]
        part = replace(part, task=_task(kind, program, part))
    if model is not None and (part.task is None or model.over_source):
        part = replace(part, model=model)
    if part.task is not None or part.model is not None:
        return part
    what = f"node {part.node.name} ({part.node.package}/{part.node.type})"
    return part.with_missing_note(what, "no source of it is here, and no model")


def _ros2_part(part: NodePart, workspace: Workspace, models: ModelCatalog) -> NodePart:
    """Return what a node of ROS 2 runs: its source, or else a model of it."""
    node = part.node
    is_here = node.package in workspace.packages
    find_task = component_task if node.container else executable_task
    task = find_task(workspace, node.package, node.type, node.site) if is_here else None
    if task is not None:
        return replace(part, task=task)
    model = models.component(node.type) or models.node(node.package, node.type)
    if model is not None:
        return replace(part, model=model)
    program = f"{node.package}/{node.type}"
    if _lacks_program(node, workspace):
        return _without_program(part)
    why = _NOT_UNDERSTOOD if is_here else _NOT_HERE
    return part.with_missing_note(f"node {node.name} ({program})", why)


def _nodelet_parts(
    loader: NodePart, workspace: Workspace, models: ModelCatalog
) -> Iterator[NodePart]:
    node = loader.node
    match positional(node.site.args, ""):
        case ["load", name, manager, *_]:
            yield loader
            owner = resolve_name(manager, node.name)
            nodelet = NodePart(node=node, owner=owner)
            yield _nodelet(nodelet, name, workspace, models)
        case ["standalone", name, *_]:
            if loader.task is not None:
                yield replace(loader, model=None)
            yield _nodelet(NodePart(node=node, owner=node.name), name, workspace, models)
        case _:
            yield loader


def _nodelet(part: NodePart, name: str, workspace: Workspace, models: ModelCatalog) -> NodePart:
    model, plugin = models.nodelet(name), workspace.nodelet(name)
    if plugin is not None and plugin.program is not None and plugin.program.sources:
        task = replace(
            _task(TaskKind.NODELET, plugin.program, part), class_name=plugin.plugin_class.type
        )
        part = replace(part, task=task)
    if model is not None and (part.task is None or model.over_source):
        part = replace(part, model=model)
    if part.task is not None or part.model is not None:
        return part
    return part.with_missing_note(f"nodelet {name}", "no source of it is here, and no model")


def _task(kind: TaskKind, program: Program, part: NodePart) -> InterpretationTask:
    return InterpretationTask(
        kind=kind,
        sources=program.sources,
        definitions=program.definitions,
        site=part.node.site,
    )

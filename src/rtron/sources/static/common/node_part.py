"""Where a node's interface is to be found: in its source, in a model, or nowhere.

A nodelet's loader has two parts: its own process, and the nodelet in its manager's process.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace

from rtron.errors import suggestion
from rtron.sources.declaration import DeclarationKind, NodeInterface
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
from rtron.sources.workspace import Plugin, Program, ProgramLanguage, Workspace
from rtron.sources.workspace.catalog import NODELET
from rtron.sources.workspace.package_files import is_in_build_files
from rtron.vocabulary import Resolution, Trust, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.launch import resolve_name

MISSING_PROGRAM = "its package is here, and makes no program of this name"
MISSING_CLASS = "its package is here, and registers no class of this name"
_NOT_HERE = "its package is not here: give the folder of its source too"
_NO_SOURCE = "no source of it is here, and no model"
_NOT_UNDERSTOOD = (
    "the build files of its package name its program in a way that is not understood, or behind a "
    "return() under no condition"
)
_NOT_FOLLOWED = "commands that are not followed make programs of its package"
_NOT_READ = "its package is here, and what this program is written in is not read"
_BUILT_OTHERWISE = "its package is here, and what builds its programs is not read"
_BUILD_TYPES = frozenset({"catkin", "cmake", "ament_cmake", "ament_cmake_auto", "ament_python"})
_NO_LIBRARY = "its package is here, and registers it in a library that is not made there"
_NO_FILES = "its package is here, and none of the sources of this program: generated or missing"
_MISSING, _PARTLY_READ = UnresolvedCause.MISSING_SOURCE, UnresolvedCause.PARTLY_READ
_TOPICS = frozenset({DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE})
_KINDS = {
    ProgramLanguage.CPP: TaskKind.CPP,
    ProgramLanguage.PYTHON: TaskKind.PYTHON,
    ProgramLanguage.SHELL: TaskKind.SHELL,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class NodePart:
    """Something of `node` that runs in the process of the node `owner`.

    `model` or `task` tells what it declares, or both: then the task tells what its source has
    beside the model. `known_model` is there beside a task, too, and counts where that does not
    tell all. `interface` is there once that is known.
    """

    node: AppNode
    owner: str
    model: Model | None = None
    known_model: Model | None = None
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

    @property
    def is_cut(self) -> bool:
        """Whether its source was run in part only, or gives no name of the topics it joins."""
        notes = self.interface.unresolved
        explicit = [each for each in self.interface.declarations if not each.implicit]
        topics = [each for each in explicit if each.kind in _TOPICS]
        is_named = any(e.resolution is not Resolution.SYMBOLIC for e in topics or explicit)
        is_open = bool(notes or explicit) and not is_named
        is_limited = any(note.cause is UnresolvedCause.LIMIT for note in notes)
        return self.task is not None and (is_limited or is_open)

    @property
    def is_whole(self) -> bool:
        """Whether its source tells all that it joins: nothing is open, and it loads no plugin."""
        interface = self.interface
        is_source = self.task is not None and self.model is None and bool(interface.declarations)
        is_open = interface.unresolved or interface.plugins or interface.runtime_starts
        return is_source and not is_open and not any("{" in d.name for d in interface.declarations)

    def with_missing_note(
        self, what: str, why: str, cause: UnresolvedCause | None = None
    ) -> "NodePart":
        """Return the part with a note instead of an interface; its nodes keep their names."""
        return self.with_only_note(UnresolvedItem(what=what, why=why, cause=cause))

    def with_only_note(self, note: UnresolvedItem) -> "NodePart":
        """Return the part with a note, at its place, instead of an interface."""
        note = replace(note, evidence=(self.node.evidence,))
        found = NodeInterface(nodes=self.interface.nodes, unresolved=(note,))
        return replace(self, interface=found)


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
    is_missing = part.task is None and part.model is None
    yield _without_program(part, workspace) if is_missing else part


def _without_program(part: NodePart, workspace: Workspace) -> NodePart:
    """Return the part with a note that tells an own package without its program from another's."""
    node = part.node
    program, trust = f"{node.package}/{node.type}", workspace.trust(node.package)
    what = f"node {node.name} ({program})"
    if trust is not Trust.OWN:
        why, cause = _NOT_HERE if trust is Trust.UNKNOWN else _NO_SOURCE, _MISSING
        return part.with_only_note(
            UnresolvedItem(what=what, why=why, package=node.package, cause=cause)
        )
    if why := _why_not_read(node, workspace):
        is_other = why in {_NOT_READ, _BUILT_OTHERWISE}
        return part.with_missing_note(what, why, _PARTLY_READ if is_other else None)
    why, names = MISSING_PROGRAM, workspace.program_names(node.package)
    if node.container:
        why, names = MISSING_CLASS, workspace.component_names(node.package)
    nearest = _nearest(node.type, names)
    why = f"{why}: {nearest}"
    return part.with_only_note(UnresolvedItem(what=what, why=why, missing=program, nearest=nearest))


def _why_not_read(node: AppNode, workspace: Workspace) -> str:
    """Return why the program of an own package is not read; empty where it is not there."""
    find = workspace.component if node.container else workspace.executable
    found = find(node.package, node.type)
    if found is not None:
        return _NOT_READ if found.sources else _NO_FILES
    entry = workspace.entry_points(node.package).get(node.type)
    if entry is not None:
        return f"its package is here, and the module {entry[0]} of this program is not"
    if node.container and node.type in workspace.component_names(node.package):
        return _NO_LIBRARY
    builds = workspace.manifest(node.package).build_types
    if builds and not builds & _BUILD_TYPES:
        return _BUILT_OTHERWISE
    is_named = is_in_build_files(workspace.files(node.package), node.type)
    contents = workspace.contents(node.package)
    is_open = contents is not None and contents.is_open
    return _NOT_UNDERSTOOD if is_named else _NOT_FOLLOWED if is_open else ""


def _nearest(name: str, names: Collection[str]) -> str:
    return suggestion(name, names) if names else "it has none"


def _with_source_or_model(part: NodePart, program: Program | None, model: Model | None) -> NodePart:
    if program is not None and program.language in _KINDS and program.sources:
        kind = _KINDS[program.language]
        part = replace(part, task=_task(kind, program, part))
    return _with_model(part, model)


def _with_model(part: NodePart, model: Model | None) -> NodePart:
    """Return the part with a model that counts over its source, or for want of it."""
    counts = model is not None and (part.task is None or model.over_source)
    return replace(part, model=model if counts else None, known_model=model)


def _ros2_part(part: NodePart, workspace: Workspace, models: ModelCatalog) -> NodePart:
    """Return what a node of ROS 2 runs: its source, or else a model of it."""
    node = part.node
    is_here = node.package in workspace.packages
    find_task = component_task if node.container else executable_task
    task = find_task(workspace, node.package, node.type, node.site) if is_here else None
    model = models.component(node.type) or models.node(node.package, node.type)
    part = _with_model(replace(part, task=task), model)
    is_missing = part.task is None and part.model is None
    return _without_program(part, workspace) if is_missing else part


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
        task = _task(TaskKind.NODELET, plugin.program, part)
        site = replace(task.site, manager=part.owner)
        task = replace(task, class_name=plugin.plugin_class.type, site=site)
        part = replace(part, task=task)
    part = _with_model(part, model)
    if part.task is not None or part.model is not None:
        return part
    why = _missing_nodelet(name, plugin, workspace)
    return part.with_missing_note(f"nodelet {name}", why, _MISSING if why == _NO_SOURCE else None)


def _missing_nodelet(name: str, plugin: Plugin | None, workspace: Workspace) -> str:
    if plugin is not None:
        library = f"its library {plugin.plugin_class.library}"
        return f"its package is here, and {library} is built by none that is, or without sources"
    if workspace.trust(name.partition("/")[0]) is not Trust.OWN:
        return _NO_SOURCE
    return f"{MISSING_CLASS}: {_nearest(name, [p.name for p in workspace.plugins(NODELET)])}"


def _task(kind: TaskKind, program: Program, part: NodePart) -> InterpretationTask:
    return InterpretationTask(
        kind=kind, sources=program.sources, definitions=program.definitions, site=part.node.site
    )

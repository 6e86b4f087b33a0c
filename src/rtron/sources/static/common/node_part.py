"""Where a node's interface is to be found: in its source, in a model, or nowhere.

A nodelet's loader has two parts: its own process, and the nodelet in its manager's process.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from rtron.sources.declaration import NodeInterface
from rtron.sources.models import Model, Models
from rtron.sources.models.common.arguments import positional
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.task import Task, TaskKind
from rtron.sources.static.ros2.programs import component_task, executable_task
from rtron.sources.workspace import Language, Program, Workspace
from rtron.vocabulary import Unresolved
from rtron.vocabulary.launch import resolve_name

_KINDS = {
    Language.CPP: TaskKind.CPP,
    Language.PYTHON: TaskKind.PYTHON,
    Language.SHELL: TaskKind.SHELL,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Something of `node` that runs in the process of the node `owner`.

    `model` or `task` tells what it declares, or both: then the task tells what its source has
    beside the model. `interface` is there once that is known.
    """

    node: AppNode
    owner: str
    model: Model | None = None
    task: Task | None = None
    interface: NodeInterface = field(default_factory=NodeInterface)

    def missing(self, what: str, why: str) -> "Part":
        """Return the part with a note instead of an interface."""
        note = Unresolved(what=what, why=why, evidence=(self.node.evidence,))
        return replace(self, interface=NodeInterface(unresolved=(note,)))


def parts_of(node: AppNode, workspace: Workspace, models: Models) -> Iterator[Part]:
    """Yield what a node runs: source where it is there, and a model that goes before it."""
    if node.site.ros > 1:
        yield _ros2_part(Part(node=node, owner=node.name), workspace, models)
        return
    model = models.node(node.package, node.type)
    own = Part(node=node, owner=node.name)
    if model is not None and model.role is NodeRole.NODELET:
        loader = _chosen(own, workspace.executable(node.package, node.type), model)
        yield from _nodelet_parts(replace(loader, model=model), workspace, models)
        return
    yield _chosen(own, workspace.executable(node.package, node.type), model)


def _chosen(own: Part, program: Program | None, model: Model | None) -> Part:
    if program is not None and program.language in _KINDS and program.sources:
        kind = _KINDS[program.language]
        own = replace(own, task=_task(kind, program, own))
    if model is not None and (own.task is None or model.over_source):
        own = replace(own, model=model)
    if own.task is not None or own.model is not None:
        return own
    what = f"node {own.node.name} ({own.node.package}/{own.node.type})"
    return own.missing(what, "no source of it is here, and no model")


def _ros2_part(part: Part, workspace: Workspace, models: Models) -> Part:
    """Return what a node of ROS 2 runs: its source, or else a model of it."""
    node = part.node
    is_here = node.package in workspace.packages
    found = component_task if node.container else executable_task
    task = found(workspace, node.package, node.type, node.site) if is_here else None
    if task is not None:
        return replace(part, task=task)
    model = models.component(node.type) or models.node(node.package, node.type)
    if model is not None:
        return replace(part, model=model)
    why = "its package is not here: give the folder of its source too"
    why = "its program is not in the build files of its package" if is_here else why
    return part.missing(f"node {node.name} ({node.package}/{node.type})", why)


def _nodelet_parts(loader: Part, workspace: Workspace, models: Models) -> Iterator[Part]:
    node = loader.node
    match positional(node.site.args, ""):
        case ["load", name, manager, *_]:
            yield loader
            owner = resolve_name(manager, node.name)
            nodelet = Part(node=node, owner=owner)
            yield _nodelet(nodelet, name, workspace, models)
        case ["standalone", name, *_]:
            if loader.task is not None:
                yield replace(loader, model=None)
            yield _nodelet(Part(node=node, owner=node.name), name, workspace, models)
        case _:
            yield loader


def _nodelet(part: Part, name: str, workspace: Workspace, models: Models) -> Part:
    model, plugin = models.nodelet(name), workspace.nodelet(name)
    if plugin is not None and plugin.program is not None and plugin.program.sources:
        task = replace(_task(TaskKind.NODELET, plugin.program, part), cls=plugin.declared.type)
        part = replace(part, task=task)
    if model is not None and (part.task is None or model.over_source):
        part = replace(part, model=model)
    if part.task is not None or part.model is not None:
        return part
    return part.missing(f"nodelet {name}", "no source of it is here, and no model")


def _task(kind: TaskKind, program: Program, part: Part) -> Task:
    return Task(
        kind=kind,
        sources=program.sources,
        definitions=program.definitions,
        site=part.node.site,
    )

"""Finds out what nodes declare: by interpreting their source, by a model, or from the cache."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce

from rtron.sources.declaration import Declaration, NodeInterface
from rtron.sources.models import Model, ModelCatalog, load_models, node_interface
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.cache import InterfaceCache
from rtron.sources.static.common.node_part import NodePart, node_parts
from rtron.sources.static.common.plugins import plugin_tasks, with_plugin
from rtron.sources.static.common.scan_options import Progress
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Resolution, Trust, UnresolvedCause, UnresolvedItem

_CUT = "its source is here and can be followed in part only; the model of that name counts, too"
_UNDECIDED = "its source leaves open whether this is made; the model of that name counts, not this"


@dataclass(slots=True, kw_only=True)
class InterfaceResolver:
    """The means of one scan; to be closed after it."""

    workspace: Workspace
    cache: InterfaceCache
    pool: WorkerPool
    progress: Progress
    models: ModelCatalog = field(default_factory=load_models)

    def resolve_nodes(self, nodes: Sequence[AppNode]) -> list[NodePart]:
        """Return the parts of nodes, each with its interface."""
        parts = [part for node in nodes for part in node_parts(node, self.workspace, self.models)]
        return self.resolve_parts(parts)

    def resolve_parts(self, parts: Sequence[NodePart]) -> list[NodePart]:
        """Return parts with their interfaces; one without a task or model stays as it is."""
        results = self._task_results([part.task for part in parts if part.task])
        return self._with_plugins([self._with_interface(part, results) for part in parts])

    def _with_plugins(self, parts: Sequence[NodePart]) -> list[NodePart]:
        """Return the parts of models with what the source of plugins says that they load."""
        tasks = [list(plugin_tasks(part, self.workspace)) for part in parts]
        results = self._task_results([task for of_part in tasks for task in of_part])
        return [
            reduce(lambda part, task: with_plugin(part, task, results[id(task)]), of_part, part)
            for part, of_part in zip(parts, tasks, strict=True)
        ]

    def close(self) -> None:
        """End the processes, and leave a cache that is not too large."""
        self.pool.close()
        self.cache.trim()

    def _task_results(self, tasks: Sequence[InterpretationTask]) -> Mapping[int, TaskResult]:
        """Return each task's result by the task's id: tasks themselves are costly to compare."""
        cached = {id(task): self.cache.get(task) for task in tasks}
        results = {key: result for key, result in cached.items() if result is not None}
        missing = [task for task in tasks if id(task) not in results]
        for task, result in self.pool.run_tasks(missing):
            self.cache.put(task, result)
            results[id(task)] = result
            self.progress(len(results), len(tasks), task.site.name)
        return results

    def _with_interface(self, part: NodePart, results: Mapping[int, TaskResult]) -> NodePart:
        if part.task is not None:
            part = replace(part, interface=results[id(part.task)].interface)
        if part.model is not None:
            return self._with_model_interface(part, part.model)
        if part.known_model is not None and part.is_cut:
            what = f"node {part.node.name} ({part.node.program})"
            note = UnresolvedItem(what=what, why=_CUT, evidence=(part.node.evidence,))
            part = self._with_model_interface(part, part.known_model)
            return replace(part, interface=_with_note(part.interface, note))
        if part.known_model is not None and any(d.undecided for d in part.interface.declarations):
            modelled = self._model_interface(part, part.known_model)
            return replace(part, interface=_decided_by_model(part.interface, modelled))
        return part

    def _model_interface(self, part: NodePart, model: Model) -> NodeInterface:
        site = part.node.site
        site = replace(site, remaps=part.node.process_remap_rules) if site.ros > 1 else site
        return node_interface(model, site, models=self.models)

    def _with_model_interface(self, part: NodePart, model: Model) -> NodePart:
        """Return the part with what a model says, and what its source says beside it."""
        interface = _with_start_location(self._model_interface(part, model), part)
        if part.task is not None:
            interface = _with_source_additions(interface, part.interface)
        elif self.workspace.trust(part.node.package) is Trust.OWN:
            interface = _note_missing_source(part, interface)
        return replace(part, model=model, interface=interface)


def _with_note(interface: NodeInterface, note: UnresolvedItem) -> NodeInterface:
    return replace(interface, unresolved=(*interface.unresolved, note))


def _decided_by_model(interface: NodeInterface, modelled: NodeInterface) -> NodeInterface:
    """Return an interface without what its source leaves open and its model does not name."""
    named = {(each.kind, each.name) for each in modelled.declarations}
    open_kinds = {e.kind for e in modelled.declarations if e.resolution is Resolution.SYMBOLIC}
    left_out = [
        each
        for each in interface.declarations
        if each.undecided
        and not each.implicit
        and (each.kind, each.name) not in named
        and each.kind not in open_kinds
    ]
    if not left_out:
        return interface
    more = f" and {len(left_out) - 1} more" if len(left_out) > 1 else ""
    places = dict.fromkeys(each.evidence[0] for each in left_out if each.evidence)
    what = f"{left_out[0].kind.value} {left_out[0].name}{more}"
    cause, evidence = UnresolvedCause.RUN_TIME, tuple(places)
    note = UnresolvedItem(what=what, why=_UNDECIDED, cause=cause, evidence=evidence)
    remaining = tuple(each for each in interface.declarations if each not in left_out)
    return _with_note(replace(interface, declarations=remaining), note)


def _with_start_location(model_interface: NodeInterface, part: NodePart) -> NodeInterface:
    """Return what a model says, with the place where its node is started before the model's."""
    location = part.node.evidence
    declarations = (
        replace(d, evidence=(location, *d.evidence)) for d in model_interface.declarations
    )
    return replace(model_interface, declarations=tuple(declarations))


def _with_source_additions(
    model_interface: NodeInterface, source_interface: NodeInterface
) -> NodeInterface:
    """Return a model's interface and what a changed source says beside it.

    A copy of a well-known package in a workspace may have been given another publisher. A name
    that the source leaves open may be one of the model's: it is noted, and what stands under a
    condition that is not known.
    """
    modelled_names = {(declared.kind, declared.name) for declared in model_interface.declarations}
    additions = [
        d
        for d in source_interface.declarations
        if not d.implicit and (d.kind, d.name) not in modelled_names
    ]
    sure = tuple(d for d in additions if not _is_open(d))
    notes = tuple(
        UnresolvedItem(
            what=f"{declared.kind.value} {declared.name}",
            why="stands in the source; the model of that name counts",
            evidence=declared.evidence,
        )
        for declared in additions
        if _is_open(declared)
    )
    return replace(
        model_interface,
        declarations=(*model_interface.declarations, *sure),
        runtime_starts=source_interface.runtime_starts,
        unresolved=(*model_interface.unresolved, *notes),
    )


def _is_open(declared: Declaration) -> bool:
    return declared.undecided or declared.resolution is Resolution.SYMBOLIC


def _note_missing_source(part: NodePart, model_interface: NodeInterface) -> NodeInterface:
    """Return a model's interface with a note that the app has a program of that name."""
    node = part.node
    what = f"node {node.name} ({node.package}/{node.type})"
    why = "its program's source is not here; the model of that name counts"
    note = UnresolvedItem(what=what, why=why, evidence=(node.evidence,))
    return _with_note(model_interface, note)

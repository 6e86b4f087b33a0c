"""Finds out what nodes declare: by interpreting their source, by a model, or from the cache."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from rtron.sources.declaration import NodeInterface
from rtron.sources.models import ModelCatalog, load_models, node_interface
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.cache import InterfaceCache
from rtron.sources.static.common.node_part import NodePart, node_parts
from rtron.sources.static.common.scan_options import Progress
from rtron.sources.static.common.task import InterpretationTask, TaskResult
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Resolution, Trust, UnresolvedItem


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
        return [self._with_interface(part, results) for part in parts]

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
        source_interface = results[id(part.task)].interface if part.task is not None else None
        if part.model is not None:
            site = part.node.site
            site = replace(site, remaps=part.node.process_remap_rules) if site.ros > 1 else site
            model_interface = _with_start_location(
                node_interface(part.model, site, models=self.models), part
            )
            if source_interface is not None:
                model_interface = _with_source_additions(model_interface, source_interface)
            elif self.workspace.trust(part.node.package) is Trust.OWN:
                model_interface = _note_missing_source(part, model_interface)
            return replace(part, interface=model_interface)
        return replace(part, interface=source_interface) if source_interface else part


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
    that the source leaves open may be one of the model's: it is noted.
    """
    modelled_names = {(declared.kind, declared.name) for declared in model_interface.declarations}
    additions = [
        d
        for d in source_interface.declarations
        if not d.implicit and (d.kind, d.name) not in modelled_names
    ]
    sure = tuple(d for d in additions if d.resolution is not Resolution.SYMBOLIC)
    notes = tuple(
        UnresolvedItem(
            what=f"{declared.kind.value} {declared.name}",
            why="stands in the source; the model of that name counts",
            evidence=declared.evidence,
        )
        for declared in additions
        if declared.resolution is Resolution.SYMBOLIC
    )
    return replace(
        model_interface,
        declarations=(*model_interface.declarations, *sure),
        runtime_starts=source_interface.runtime_starts,
        unresolved=(*model_interface.unresolved, *notes),
    )


def _note_missing_source(part: NodePart, model_interface: NodeInterface) -> NodeInterface:
    """Return a model's interface with a note that the app has a program of that name."""
    node = part.node
    what = f"node {node.name} ({node.package}/{node.type})"
    why = "its program's source is not here; the model of that name counts"
    note = UnresolvedItem(what=what, why=why, evidence=(node.evidence,))
    return replace(model_interface, unresolved=(*model_interface.unresolved, note))

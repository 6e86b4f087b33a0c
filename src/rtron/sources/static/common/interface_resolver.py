"""Finds out what nodes declare: by interpreting their source, by a model, or from the cache."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from rtron.sources.declaration import NodeInterface
from rtron.sources.models import Models, interface, load_models
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.cache import Cache
from rtron.sources.static.common.node_part import Part, parts_of
from rtron.sources.static.common.scan_options import Progress
from rtron.sources.static.common.task import Task, TaskResult
from rtron.sources.static.common.worker_pool import Pool
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Resolution, Trust, Unresolved


@dataclass(slots=True, kw_only=True)
class Interpreting:
    """The means of one scan; to be closed after it."""

    workspace: Workspace
    cache: Cache
    pool: Pool
    progress: Progress
    models: Models = field(default_factory=load_models)

    def parts(self, nodes: Sequence[AppNode]) -> list[Part]:
        """Return the parts of nodes, each with its interface."""
        parts = [part for node in nodes for part in parts_of(node, self.workspace, self.models)]
        return self.finished(parts)

    def finished(self, parts: Sequence[Part]) -> list[Part]:
        """Return parts with their interfaces; one without a task or model stays as it is."""
        results = self._results([part.task for part in parts if part.task])
        return [self._with_interface(part, results) for part in parts]

    def close(self) -> None:
        """End the processes, and leave a cache that is not too large."""
        self.pool.close()
        self.cache.trim()

    def _results(self, tasks: Sequence[Task]) -> Mapping[int, TaskResult]:
        """Return each task's result by the task's id: tasks themselves are costly to compare."""
        known = {id(task): self.cache.get(task) for task in tasks}
        results = {key: result for key, result in known.items() if result is not None}
        missing = [task for task in tasks if id(task) not in results]
        for task, result in self.pool.run(missing):
            self.cache.put(task, result)
            results[id(task)] = result
            self.progress(len(results), len(tasks), task.site.name)
        return results

    def _with_interface(self, part: Part, results: Mapping[int, TaskResult]) -> Part:
        read = results[id(part.task)].interface if part.task is not None else None
        if part.model is not None:
            site = part.node.site
            site = replace(site, remaps=part.node.rules) if site.ros > 1 else site
            modelled = _placed(interface(part.model, site, models=self.models), part)
            if read is not None:
                modelled = _with_new(modelled, read)
            elif self.workspace.trust(part.node.package) is Trust.OWN:
                modelled = _without_source(part, modelled)
            return replace(part, interface=modelled)
        return replace(part, interface=read) if read else part


def _placed(modelled: NodeInterface, part: Part) -> NodeInterface:
    """Return what a model says, with the place where its node is started before the model's."""
    place = part.node.evidence
    declarations = (replace(d, evidence=(place, *d.evidence)) for d in modelled.declarations)
    return replace(modelled, declarations=tuple(declarations))


def _with_new(modelled: NodeInterface, read: NodeInterface) -> NodeInterface:
    """Return a model's interface and what a changed source says beside it.

    A copy of a well-known package in a workspace may have been given another publisher. A name
    that the source leaves open may be one of the model's: it is noted.
    """
    known = {(declared.kind, declared.name) for declared in modelled.declarations}
    new = [d for d in read.declarations if not d.implicit and (d.kind, d.name) not in known]
    sure = tuple(d for d in new if d.resolution is not Resolution.SYMBOLIC)
    notes = tuple(
        Unresolved(
            what=f"{declared.kind.value} {declared.name}",
            why="stands in the source; the model of that name counts",
            evidence=declared.evidence,
        )
        for declared in new
        if declared.resolution is Resolution.SYMBOLIC
    )
    return replace(
        modelled,
        declarations=(*modelled.declarations, *sure),
        starts=read.starts,
        unresolved=(*modelled.unresolved, *notes),
    )


def _without_source(part: Part, modelled: NodeInterface) -> NodeInterface:
    """Return a model's interface with a note that the app has a program of that name."""
    node = part.node
    what = f"node {node.name} ({node.package}/{node.type})"
    why = "its program's source is not here; the model of that name counts"
    note = Unresolved(what=what, why=why, evidence=(node.evidence,))
    return replace(modelled, unresolved=(*modelled.unresolved, note))

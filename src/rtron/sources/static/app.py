"""From folders and launch files to the interaction graph of the app that they start."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.launch.reader import read_launches
from rtron.sources.models import Models, interface, load_models
from rtron.sources.models.packages import known_packages
from rtron.sources.static.assembly import Assembly
from rtron.sources.static.cache import Cache, open_cache
from rtron.sources.static.node import AppNode, launched_node
from rtron.sources.static.options import ScanOptions
from rtron.sources.static.part import Part, parts_of
from rtron.sources.static.pool import Pool
from rtron.sources.static.simulation import Simulation
from rtron.sources.static.started import ROSRUN, StartedFile, started_file, started_node
from rtron.sources.static.structure import workspace_state
from rtron.sources.static.task import Task, TaskResult
from rtron.sources.workspace import Workspace, read_workspace
from rtron.sources.xacro import RobotDescriptions
from rtron.vocabulary import Evidence, InteractionGraph, LaunchTree, Parameters, Unresolved

MAX_ROUNDS = 8
MAX_STARTED = 1000

Launch: TypeAlias = tuple[Path, Mapping[str, str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class StaticApp:
    """The graph, and the launch trees in the order of their start: the given ones first.

    `started` has those that nodes start themselves, after the given ones in `trees`.
    """

    graph: InteractionGraph
    trees: tuple[LaunchTree, ...]
    started: tuple[StartedFile, ...] = ()
    parameters: Parameters = field(default_factory=Parameters)


def scan_app(
    folders: Iterable[Path],
    launches: Sequence[Launch],
    environ: Mapping[str, str],
    options: ScanOptions | None = None,
) -> StaticApp:
    """Return the interaction graph of the app that launch files start.

    `environ` is the app's environment, ROS_PACKAGE_PATH included. Raise InputError if a given
    launch file is wrong; what is wrong elsewhere stands in the graph's `unresolved`.
    """
    chosen, workspace = options or ScanOptions(), read_workspace(folders, environ)
    state = workspace_state(workspace) if chosen.cache else ""
    scan = _Scan(
        workspace=workspace,
        environ=environ,
        options=chosen,
        cache=open_cache(chosen.cache, state),
        pool=Pool(workspace, chosen.workers, chosen.seconds),
        descriptions=RobotDescriptions(packages=workspace.packages, environ=environ),
    )
    try:
        return scan.run(launches)
    finally:
        scan.pool.close()
        scan.cache.trim()


@dataclass(slots=True, kw_only=True)
class _Scan:
    """One scan: rounds of launch files, of the nodes they start, of what those start in turn."""

    workspace: Workspace
    environ: Mapping[str, str]
    options: ScanOptions
    cache: Cache
    pool: Pool
    descriptions: RobotDescriptions
    models: Models = field(default_factory=load_models)
    parts: list[Part] = field(default_factory=list)
    nodes: list[AppNode] = field(default_factory=list)
    started: list[StartedFile] = field(default_factory=list)
    notes: list[Unresolved] = field(default_factory=list)
    _seen: set[tuple[object, ...]] = field(default_factory=set)

    def run(self, launches: Sequence[Launch]) -> StaticApp:
        self._seen.update((path.absolute(), tuple(sorted(a.items()))) for path, a in launches)
        trees = self._read(launches)
        waiting = [node for tree in trees for node in self._launched(tree, "")]
        for _ in range(MAX_ROUNDS):
            parts = self._interpreted(waiting)
            files, waiting = self._starts(parts, _parameters(trees))
            if not files and not waiting:
                break
            trees = self._read_more(trees, launches, files)
            for tree, file in zip(trees[len(trees) - len(files) :], files, strict=True):
                waiting.extend(self._launched(tree, file.by))
        for node in waiting:
            why = f"what starts it was started itself, and so on, {MAX_ROUNDS} deep"
            self._note(f"node {node.name}", why, node.evidence)
        return self._result(trees)

    def _read(self, launches: Sequence[Launch]) -> tuple[LaunchTree, ...]:
        describe = self.descriptions.describe
        packages = {**known_packages(), **self.workspace.packages}
        return read_launches(launches, packages, self.environ, describe=describe)

    def _read_more(
        self, trees: tuple[LaunchTree, ...], launches: Sequence[Launch], files: list[StartedFile]
    ) -> tuple[LaunchTree, ...]:
        """Return the trees with those of more files; one that cannot be read leaves `files`."""
        with suppress(InputError):
            trees = self._read([*launches, *_launches([*self.started, *files])])
            self.started.extend(files)
            return trees
        for file in tuple(files):
            more = self._tried(launches, file)
            if more is None:
                files.remove(file)
            else:
                trees = more
                self.started.append(file)
        return trees

    def _tried(
        self, launches: Sequence[Launch], file: StartedFile
    ) -> tuple[LaunchTree, ...] | None:
        try:
            return self._read([*launches, *_launches([*self.started, file])])
        except InputError as error:
            self._note(f"launch {file.path.name} that {file.by} starts", str(error), file.evidence)
            return None

    def _launched(self, tree: LaunchTree, started_by: str) -> list[AppNode]:
        return [
            replace(
                launched_node(node, file.path, tree.parameters, self.environ),
                started_by=started_by,
            )
            for file in tree.root.walk()
            for node in file.nodes
        ]

    def _interpreted(self, nodes: Sequence[AppNode]) -> list[Part]:
        parts = [part for node in nodes for part in parts_of(node, self.workspace, self.models)]
        results = self._results([part.task for part in parts if part.task])
        done = [self._with_interface(part, results) for part in parts]
        self.nodes.extend(nodes)
        self.parts.extend(done)
        return done

    def _results(self, tasks: Sequence[Task]) -> Mapping[int, TaskResult]:
        """Return each task's result by the task's id: tasks themselves are costly to compare."""
        known = {id(task): self.cache.get(task) for task in tasks}
        results = {key: result for key, result in known.items() if result is not None}
        missing = [task for task in tasks if id(task) not in results]
        done = len(tasks) - len(missing)
        for task, result in self.pool.run(missing):
            self.cache.put(task, result)
            results[id(task)] = result
            done += 1
            self.options.progress(done, len(tasks), task.site.name)
        return results

    def _with_interface(self, part: Part, results: Mapping[int, TaskResult]) -> Part:
        if part.task is not None:
            return replace(part, interface=results[id(part.task)].interface)
        if part.model is not None:
            found = interface(part.model, part.node.site, models=self.models)
            return replace(part, interface=found)
        return part

    def _starts(
        self, parts: Sequence[Part], parameters: Parameters
    ) -> tuple[list[StartedFile], list[AppNode]]:
        files: list[StartedFile] = []
        nodes: list[AppNode] = []
        for part, started in ((p, s) for p in parts for s in p.interface.starts):
            if started.args[:1] == (ROSRUN,):
                node = started_node(started, part, parameters)
                if self._is_new(
                    (node.package, node.type, node.name, node.site.args), node.evidence
                ):
                    nodes.append(node)
                continue
            file = started_file(started, part, self.workspace)
            if isinstance(file, Unresolved):
                self.notes.append(file)
            elif self._is_new((file.path, file.args), file.evidence):
                files.append(file)
        return files, nodes

    def _is_new(self, key: tuple[object, ...], place: Evidence) -> bool:
        if key in self._seen:
            return False
        self._seen.add(key)
        if len(self._seen) > MAX_STARTED:
            self._note("what nodes start", f"more than {MAX_STARTED} launches and nodes", place)
        return len(self._seen) <= MAX_STARTED

    def _note(self, what: str, why: str, place: Evidence) -> None:
        self.notes.append(Unresolved(what=what, why=why, evidence=(place,)))

    def _result(self, trees: tuple[LaunchTree, ...]) -> StaticApp:
        simulation = Simulation(
            workspace=self.workspace,
            models=self.models,
            descriptions=self.descriptions,
            environ=self.environ,
        )
        assembly = Assembly(workspace=self.workspace)
        for node in self.nodes:
            assembly.add_node(node)
        for part in (*self.parts, *simulation.parts(self.parts)):
            assembly.add(part)
        assembly.add_clock(self.parts, _parameters(trees))
        assembly.note(*(note for tree in trees for note in tree.unresolved), *self.notes)
        assembly.note(*simulation.unresolved(), *self._workspace_notes())
        assembly.note(*(n for found in self.descriptions.results() for n in found.unresolved))
        app = Path(trees[0].root.path).stem if trees else ""
        return StaticApp(
            graph=assembly.graph(app),
            trees=trees,
            started=tuple(self.started),
            parameters=_parameters(trees),
        )

    def _workspace_notes(self) -> list[Unresolved]:
        """Return what is unclear in the build files of the packages that nodes come from."""
        used = {self.workspace.packages.get(node.package) for node in self.nodes}
        folders = tuple(f"{path}/" for path in used if path)
        notes = self.workspace.unresolved()
        return [n for n in notes if any(e.file.startswith(folders) for e in n.evidence)]


def _parameters(trees: Sequence[LaunchTree]) -> Parameters:
    return trees[0].parameters if trees else Parameters()


def _launches(files: Iterable[StartedFile]) -> list[Launch]:
    return [(file.path, dict(file.args)) for file in files]

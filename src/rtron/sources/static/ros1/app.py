"""From folders and launch files to the interaction graph of the app that they start."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.common.undeclared_arguments import undeclared_arguments
from rtron.sources.launch.ros1.reader import read_launches
from rtron.sources.models.packages import known_packages
from rtron.sources.static.common.app_node import AppNode, node_of_launch
from rtron.sources.static.common.cache import hash_workspace, open_cache
from rtron.sources.static.common.firmware import with_firmware
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.launch_paths import LaunchRequest
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.unresolved import UnresolvedList
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.ros1.assembly import Assembly
from rtron.sources.static.ros1.node_parameters import unread_parameters
from rtron.sources.static.ros1.runtime_launches import RuntimeLaunch, RuntimeLaunches
from rtron.sources.static.ros1.simulation import Simulation
from rtron.sources.workspace import read_workspace
from rtron.sources.xacro import RobotDescriptions
from rtron.vocabulary import InteractionGraph, LaunchTree, ParameterTree
from rtron.vocabulary.enums import HiddenPart


@dataclass(slots=True, kw_only=True)
class LaunchTrees:
    """The trees, the given launch files' first; `runtime_launches` are those that nodes start."""

    requested: tuple[LaunchRequest, ...]
    packages: PackageIndex
    folders: tuple[Path, ...]
    descriptions: RobotDescriptions
    trees: tuple[LaunchTree, ...] = ()
    runtime_launches: list[RuntimeLaunch] = field(default_factory=list)
    unresolved: UnresolvedList = field(default_factory=UnresolvedList)

    @property
    def parameters(self) -> ParameterTree:
        """The parameter server after all that was read so far."""
        return self.trees[0].parameters if self.trees else ParameterTree()

    def read_requested(self) -> list[AppNode]:
        """Return the nodes of the given launch files; raise InputError if one is wrong."""
        self.trees = self._read(())
        return [node for tree in self.trees for node in self._nodes(tree, "")]

    def read_runtime_launches(self, files: Iterable[RuntimeLaunch]) -> list[AppNode]:
        """Return the nodes of launch files that nodes start; one that is wrong is noted."""
        launches = list(files)
        with suppress(InputError):
            return self._add_launches(launches)
        return [node for file in launches for node in self._read_one(file)]

    def _read_one(self, file: RuntimeLaunch) -> list[AppNode]:
        try:
            return self._add_launches([file])
        except InputError as error:
            what = f"launch {file.path.name} that {file.started_by} starts"
            self.unresolved.add(what, str(error), file.evidence, HiddenPart.NODES)
            return []

    def _add_launches(self, files: list[RuntimeLaunch]) -> list[AppNode]:
        if not files:
            return []
        trees = self._read((*self.runtime_launches, *files))
        added = zip(trees[len(self.trees) :], files, strict=True)
        self.trees = trees
        self.runtime_launches.extend(files)
        return [node for tree, file in added for node in self._nodes(tree, file.started_by)]

    def _read(self, files: Iterable[RuntimeLaunch]) -> tuple[LaunchTree, ...]:
        return read_launches(
            [*self.requested, *((file.path, dict(file.args)) for file in files)],
            self.packages,
            self.descriptions.environ,
            describe=self.descriptions.describe,
            roots=self._roots(),
        )

    def _roots(self) -> Iterator[Path]:
        """Yield the folders that launch files and their data may lie in."""
        yield from self.folders
        yield from self.packages.values()
        yield from (path.absolute().parent for path, _ in self.requested)

    def _nodes(self, tree: LaunchTree, started_by: str) -> list[AppNode]:
        environ = self.descriptions.environ
        nodes = (
            node_of_launch(node, file.path, tree.parameters, environ)
            for file in tree.root.walk()
            for node in file.nodes
        )
        return [replace(node, started_by=started_by) for node in nodes]


MAX_ROUNDS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class StaticApp:
    """The graph, and the launch trees in the order of their start: the given ones first.

    `started` has those that nodes start themselves, after the given ones in `trees`.
    """

    graph: InteractionGraph
    trees: tuple[LaunchTree, ...]
    started: tuple[RuntimeLaunch, ...] = ()
    parameters: ParameterTree = field(default_factory=ParameterTree)


def scan_app(
    folders: Iterable[Path],
    launches: Sequence[LaunchRequest],
    environ: Mapping[str, str],
    options: ScanOptions | None = None,
) -> StaticApp:
    """Return the interaction graph of the app that launch files start.

    `environ` is the app's environment, ROS_PACKAGE_PATH included. Raise InputError if a given
    launch file is wrong; what is wrong elsewhere stands in the graph's `unresolved`.
    """
    scan_options, workspace = options or ScanOptions(), read_workspace(folders, environ)
    packages = {**known_packages(), **workspace.packages}
    descriptions = RobotDescriptions(packages=packages, environ=environ)
    state = hash_workspace(workspace) if scan_options.cache else ""
    resolver = InterfaceResolver(
        workspace=workspace,
        cache=open_cache(scan_options.cache, state),
        pool=WorkerPool(
            workspace, scan_options.workers, scan_options.seconds, scan_options.start_method
        ),
        progress=scan_options.progress,
    )
    launch_trees = LaunchTrees(
        requested=tuple(launches),
        packages=packages,
        folders=workspace.folders,
        descriptions=descriptions,
    )
    with closing(resolver):
        parts, nodes = _read_nodes(launch_trees, resolver)
        parts = with_firmware(parts, resolver)
    return _assemble(launch_trees, resolver, parts, nodes)


def _read_nodes(
    launch_trees: LaunchTrees, resolver: InterfaceResolver
) -> tuple[list[NodePart], list[AppNode]]:
    """Return the parts and nodes: of the launch files, of what their nodes start, and so on."""
    runtime_launches = RuntimeLaunches(
        resolver.workspace, launch_trees.requested, launch_trees.unresolved
    )
    parts: list[NodePart] = []
    nodes: list[AppNode] = []
    pending = launch_trees.read_requested()
    for _ in range(MAX_ROUNDS):
        nodes.extend(pending)
        new_parts = resolver.resolve_nodes(pending)
        parts.extend(new_parts)
        files, pending = runtime_launches.new_starts(new_parts, launch_trees.parameters)
        pending.extend(launch_trees.read_runtime_launches(files))
        if not pending:
            break
    for node in pending:
        why = f"launch files start each other more than {MAX_ROUNDS} levels deep"
        launch_trees.unresolved.add(f"node {node.name}", why, node.evidence)
    return parts, nodes


def _assemble(
    launch_trees: LaunchTrees,
    resolver: InterfaceResolver,
    parts: Sequence[NodePart],
    nodes: Sequence[AppNode],
) -> StaticApp:
    workspace, descriptions = resolver.workspace, launch_trees.descriptions
    simulation = Simulation(workspace=workspace, models=resolver.models, descriptions=descriptions)
    assembly = Assembly(workspace=workspace)
    for node in nodes:
        assembly.add_node(node)
    for part in (*parts, *simulation.parts(parts)):
        assembly.add_part(part)
    assembly.add_clock(parts, launch_trees.parameters)
    assembly.add_wiring_facts(launch_trees.trees, launch_trees.parameters)
    assembly.add_parameters(launch_trees.parameters)
    assembly.add_wiring(*unread_parameters(parts, launch_trees.parameters))
    assembly.add_unresolved(*(note for tree in launch_trees.trees for note in tree.unresolved))
    passed = {name for _, given in launch_trees.requested for name in given}
    declared = {name for tree in launch_trees.trees for name in tree.declared}
    assembly.add_unresolved(*undeclared_arguments(passed, declared))
    assembly.add_unresolved(*launch_trees.unresolved.entries, *simulation.unresolved())
    assembly.add_unresolved(*workspace.unresolved_in(node.package for node in nodes))
    assembly.add_unresolved(
        *(note for description in descriptions.results() for note in description.unresolved)
    )
    app = Path(launch_trees.trees[0].root.path).stem if launch_trees.trees else ""
    return StaticApp(
        graph=assembly.build(app),
        trees=launch_trees.trees,
        started=tuple(launch_trees.runtime_launches),
        parameters=launch_trees.parameters,
    )

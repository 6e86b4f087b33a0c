"""From folders and launch files to the interaction graph of the app that they start."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.launch.common.undeclared_arguments import undeclared_arguments
from rtron.sources.models.packages import known_packages
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.launch_paths import LaunchRequest
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.common.workspace_hash import hash_workspace
from rtron.sources.static.ros1.assembly import Assembly
from rtron.sources.static.ros1.firmware import with_firmware
from rtron.sources.static.ros1.launch_trees import LaunchTrees
from rtron.sources.static.ros1.node_parameters import unread_parameters
from rtron.sources.static.ros1.runtime_launches import RuntimeLaunch, RuntimeLaunches
from rtron.sources.static.ros1.simulation import Simulation
from rtron.sources.workspace import read_workspace
from rtron.sources.xacro import RobotDescriptions
from rtron.vocabulary import InteractionGraph, LaunchTree, ParameterTree

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

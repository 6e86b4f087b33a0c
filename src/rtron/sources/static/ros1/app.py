"""From folders and launch files to the interaction graph of the app that they start."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.models.packages import known_packages
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.interface_resolver import Interpreting
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.worker_pool import Pool
from rtron.sources.static.common.workspace_hash import workspace_state
from rtron.sources.static.ros1.assembly import Assembly
from rtron.sources.static.ros1.launch_trees import Launch, StartedLaunches
from rtron.sources.static.ros1.runtime_launches import StartedFile, Starts
from rtron.sources.static.ros1.simulation import Simulation
from rtron.sources.workspace import Workspace, read_workspace
from rtron.sources.xacro import RobotDescriptions
from rtron.vocabulary import InteractionGraph, LaunchTree, Parameters, Unresolved

MAX_ROUNDS = 8


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
    packages = {**known_packages(), **workspace.packages}
    descriptions = RobotDescriptions(packages=packages, environ=environ)
    state = workspace_state(workspace) if chosen.cache else ""
    interpreting = Interpreting(
        workspace=workspace,
        cache=open_cache(chosen.cache, state),
        pool=Pool(workspace, chosen.workers, chosen.seconds),
        progress=chosen.progress,
    )
    started = StartedLaunches(
        given=tuple(launches),
        packages=packages,
        folders=workspace.folders,
        descriptions=descriptions,
    )
    with closing(interpreting):
        parts, nodes = _run(started, interpreting)
    return _assembled(started, interpreting, parts, nodes)


def _run(started: StartedLaunches, interpreting: Interpreting) -> tuple[list[Part], list[AppNode]]:
    """Return the parts and nodes: of the launch files, of what their nodes start, and so on."""
    starts = Starts(interpreting.workspace, started.given, started.notes)
    parts: list[Part] = []
    nodes: list[AppNode] = []
    waiting = started.read()
    for _ in range(MAX_ROUNDS):
        nodes.extend(waiting)
        new = interpreting.parts(waiting)
        parts.extend(new)
        files, waiting = starts.of(new, started.parameters)
        waiting.extend(started.read_more(files))
        if not waiting:
            break
    for node in waiting:
        why = f"what starts it was started itself, and so on, {MAX_ROUNDS} deep"
        started.notes.add(f"node {node.name}", why, node.evidence)
    return parts, nodes


def _assembled(
    started: StartedLaunches,
    interpreting: Interpreting,
    parts: Sequence[Part],
    nodes: Sequence[AppNode],
) -> StaticApp:
    workspace, descriptions = interpreting.workspace, started.descriptions
    simulation = Simulation(
        workspace=workspace, models=interpreting.models, descriptions=descriptions
    )
    assembly = Assembly(workspace=workspace)
    for node in nodes:
        assembly.add_node(node)
    for part in (*parts, *simulation.parts(parts)):
        assembly.add(part)
    assembly.add_clock(parts, started.parameters)
    assembly.note(*(note for tree in started.trees for note in tree.unresolved))
    assembly.note(*started.notes.unresolved, *simulation.unresolved())
    assembly.note(*_workspace_notes(workspace, nodes))
    assembly.note(*(note for found in descriptions.results() for note in found.unresolved))
    app = Path(started.trees[0].root.path).stem if started.trees else ""
    return StaticApp(
        graph=assembly.graph(app),
        trees=started.trees,
        started=tuple(started.files),
        parameters=started.parameters,
    )


def _workspace_notes(workspace: Workspace, nodes: Iterable[AppNode]) -> list[Unresolved]:
    """Return what is unclear in the build files of the packages that nodes come from."""
    used = {workspace.packages.get(node.package) for node in nodes}
    folders = tuple(f"{path}/" for path in used if path)
    notes = workspace.unresolved()
    return [n for n in notes if any(e.file.startswith(folders) for e in n.evidence)]

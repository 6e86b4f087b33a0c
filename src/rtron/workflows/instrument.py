"""Write the launch file that starts an app with its guard."""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.coherence import guards_nothing
from rtron.errors import InputError
from rtron.planning.instrument import (
    GuardedLaunch,
    RuntimeLaunchTree,
    instrument_ros1,
    instrument_ros2,
    write_guarded_launch,
)
from rtron.planning.instrument.common.cells import Cell, plan_cells
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.planning.instrument.ros2.enclaves import Enclaves
from rtron.planning.plan_file.loader import parse_plan, read_text
from rtron.planning.problem import PlanProblem
from rtron.sources.graph_json import graph_to_json, read_graph
from rtron.sources.launch.common.environment import LaunchEnvironment
from rtron.sources.launch.common.launch_file import launch_generation
from rtron.sources.launch.common.packages import find_packages, package_folder
from rtron.sources.launch.common.undeclared_arguments import undeclared_arguments
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.sources.static.common.launch_paths import find_launch_file
from rtron.sources.workspace import read_workspace
from rtron.sources.workspace.package_files import is_regular
from rtron.vocabulary import InteractionGraph, Plan
from rtron.workflows.app_environment import given_environment, robot_environment
from rtron.workflows.check_plan import require_fit
from rtron.workflows.scan import scan_graph
from rtron.workflows.unguarded import find_unguarded_commands

if TYPE_CHECKING:
    from rtron.sources.static.ros1.app import StaticApp


@dataclass(frozen=True, slots=True, kw_only=True)
class InstrumentRequest:
    """A launch file with its arguments, the plan that guards it, and where the result goes.

    Packages are looked for in `folders`, then as ROS does; without folders first in the package of
    a launch file that is a path. The guard checks the plan against the
    app's `graph` whenever it starts. With a `keystore`, each process of the graph starts in its
    enclave. `cells` are nodes that run in a cell, beside those of the plan, and `cell_options`
    those of `rtron cell`.
    """

    launch: str
    arguments: Mapping[str, str]
    folders: Sequence[Path]
    plan: Path
    output: Path
    graph: Path | None = None
    keystore: Path | None = None
    cells: Sequence[str] = ()
    cell_options: Sequence[str] = ()
    env: Sequence[str] = ()
    env_all: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class _Launch:
    """The launch file of a request, found, with the environment that it is read in."""

    path: Path
    arguments: Mapping[str, str]
    environ: LaunchEnvironment
    packages: Mapping[str, Path]


@dataclass(frozen=True, slots=True)
class InstrumentResult:
    """The launch files that were written, for an app of ROS 1 or 2.

    Without a `launch` the plan guards nothing, and `left_out` says why.
    """

    ros: int
    launch: GuardedLaunch | None
    left_out: tuple[PlanProblem, ...] = ()


def instrument(request: InstrumentRequest) -> InstrumentResult:
    """Write the guarded launch of an app; raise InputError if the launch file or plan is unfit.

    Of a plan that guards nothing none is written, unless enclaves keep nodes out.
    """
    text = read_text(request.plan)
    plan = parse_plan(text, str(request.plan))
    text, plan = _with_cells(text, plan, request)
    request = _with_folders(request)
    source = _find_launch(request)
    _check_launch_generation(source.path, plan, str(request.plan))
    if request.keystore and plan.ros == 1:
        raise InputError("ROS 1 has no enclaves", help="leave --keystore out; see `rtron master`")
    guarded = _instrument_ros1 if plan.ros == 1 else _instrument_ros2
    graph = _read_graph(request, plan)
    if guards_nothing(plan) and not request.keystore:
        left_out = find_unguarded_commands(plan, scan_graph(graph) if graph else None)
        return InstrumentResult(plan.ros, None, left_out)
    files = GuardFiles(text, json.dumps(graph_to_json(graph)) if graph else "")
    cells = plan_cells(graph, plan, request.cell_options) if graph else ()
    launch = guarded(request, source, plan, files, cells)
    notes = (*launch.notes, *(f"{note.what} {note.why}" for note in source.environ.notes()))
    launch = replace(launch, notes=notes)
    write_guarded_launch(launch)
    return InstrumentResult(plan.ros, launch)


def _with_folders(request: InstrumentRequest) -> InstrumentRequest:
    """Return a request with the folders of its packages, where it has none.

    They are the package that the launch file lies in, or the working folder for a launch file of a
    package that ROS does not find.
    """
    if request.folders:
        return request
    path = Path(request.launch)
    if is_regular(path):
        package = package_folder(path)
        return replace(request, folders=(package,) if package else ())
    environ = _environment(request)
    try:
        find_launch_file(request.launch, read_workspace((), environ), environ)
    except InputError:
        return replace(request, folders=(Path(),))
    return request


def _environment(request: InstrumentRequest) -> LaunchEnvironment:
    return robot_environment(given_environment(request.env, take_all=request.env_all))


def _find_launch(request: InstrumentRequest) -> _Launch:
    """Return the launch file of a request; raise InputError if it is nowhere."""
    environ = _environment(request)
    workspace = read_workspace(request.folders, environ)
    return _Launch(
        path=find_launch_file(request.launch, workspace, environ),
        arguments=request.arguments,
        environ=environ,
        packages=find_packages(request.folders, environ),
    )


def _instrument_ros1(
    request: InstrumentRequest,
    source: _Launch,
    plan: Plan,
    guard: GuardFiles,
    cells: Sequence[Cell],
) -> GuardedLaunch:
    from rtron.sources.static.ros1.app import scan_app  # noqa: PLC0415 - ROS 2 does without it

    app = scan_app(request.folders, [(source.path, source.arguments)], source.environ)
    launch = instrument_ros1(
        app.trees[0],
        plan,
        request.output,
        guard,
        started=_started_launches(app),
        packages=source.packages,
        cells=cells,
    )
    return _with_undeclared(launch, source, app.trees[0].declared)


def _with_cells(text: str, plan: Plan, request: InstrumentRequest) -> tuple[str, Plan]:
    """Return a plan, and its text, with the cells of a request; InputError if it has others."""
    added = tuple(dict.fromkeys(request.cells))
    if added and plan.cell and set(added) != set(plan.cell):
        help = "leave --cell out, or change the plan"
        raise InputError(f"has `cell: [{', '.join(plan.cell)}]`", path=str(request.plan), help=help)
    cells = plan.cell or added
    if cells and request.graph is None:
        help = "add --graph: `rtron scan` writes it"
        raise InputError("a cell needs the app's graph, which tells what passes", help=help)
    if len(cells) > 1 and "--user" in request.cell_options:
        help = "leave --cell-user out, and write `--user` into the script of each"
        raise InputError(f"{', '.join(cells)} need a user each", help=help)
    if not added or plan.cell:
        return text, plan
    text = f"{text.rstrip()}\ncell: [{', '.join(added)}]\n"
    return text, parse_plan(text, str(request.plan))


def _read_graph(request: InstrumentRequest, plan: Plan) -> InteractionGraph | None:
    """Return the app's graph, if it is given; InputError if the plan does not fit it."""
    if request.graph is None:
        return None
    graph = read_graph(request.graph)
    require_fit(plan, graph)
    return graph


def _started_launches(app: "StaticApp") -> Sequence[RuntimeLaunchTree]:
    """Return the launch files that nodes start; their trees come after the app's own."""
    return [
        RuntimeLaunchTree(tree=tree, starter=file.started_by, evidence=(file.evidence,))
        for tree, file in zip(app.trees[1:], app.started, strict=True)
    ]


def _instrument_ros2(
    request: InstrumentRequest,
    source: _Launch,
    plan: Plan,
    guard: GuardFiles,
    cells: Sequence[Cell],
) -> GuardedLaunch:
    if cells and request.keystore:
        raise InputError("SROS2 and a cell do not work together", help="choose one of the two")
    tree = read_ros2_launch(source.path, source.arguments, source.environ, source.packages)
    enclaves = _enclaves(request, plan)
    launch = instrument_ros2(tree, plan, request.output, guard, enclaves, cells)
    return _with_undeclared(launch, source, tree.declared)


def _enclaves(request: InstrumentRequest, plan: Plan) -> Enclaves | None:
    if request.keystore is None:
        return None
    from rtron.workflows.secure import find_enclaves  # noqa: PLC0415 - cryptography loads slowly

    return find_enclaves(request.keystore, request.graph, plan)


def _with_undeclared(
    launch: GuardedLaunch, source: _Launch, declared: Collection[str]
) -> GuardedLaunch:
    """Return a guarded launch with notes on the arguments that none of its files declares."""
    notes = undeclared_arguments(source.arguments, declared)
    return replace(launch, notes=(*launch.notes, *(f"{note.what}: {note.why}" for note in notes)))


def _check_launch_generation(launch: Path, plan: Plan, path: str) -> None:
    """Raise InputError if a launch file is for another ROS than the plan, read from `path`."""
    if launch.is_file() and launch_generation(launch) != plan.ros:
        help = f"{path} says `ros: {plan.ros}`; make a plan for ROS {3 - plan.ros}"
        raise InputError(f"is no launch file of ROS {plan.ros}", path=str(launch), help=help)

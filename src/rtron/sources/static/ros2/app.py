"""From folders and launch files of ROS 2 to the interaction graph of the app that they start."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.launch.common.yaml_tree import YamlTree
from rtron.sources.launch.ros2.app import read_app_launch
from rtron.sources.launch.ros2.executed.execution import Execution
from rtron.sources.launch.ros2.executed.lines import with_lines
from rtron.sources.launch.ros2.executed.openness import leaves_open
from rtron.sources.launch.ros2.result import AppLaunch
from rtron.sources.models import LIBRARY2, Models, load_models
from rtron.sources.static.common.cache import open_cache
from rtron.sources.static.common.interface_resolver import Interpreting
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.worker import deep_recursion
from rtron.sources.static.common.worker_pool import Pool
from rtron.sources.static.common.workspace_hash import workspace_state
from rtron.sources.static.ros1.launch_trees import Launch
from rtron.sources.static.ros2.app_nodes import StartedNodes
from rtron.sources.static.ros2.assembly import Ros2Assembly
from rtron.sources.static.ros2.controllers import ControllerNodes
from rtron.sources.static.ros2.gazebo_plugins import GazeboNodes
from rtron.sources.static.ros2.gazebo_server import GazeboServers
from rtron.sources.static.ros2.standard_nodes import with_known
from rtron.sources.static.ros2_repeated import repeated
from rtron.sources.static.ros2_scan import ros2_workspace
from rtron.sources.workspace import Workspace
from rtron.vocabulary import InteractionGraph


def scan_ros2_app(
    folders: Iterable[Path],
    launches: Sequence[Launch],
    environ: Mapping[str, str],
    options: ScanOptions | None = None,
) -> InteractionGraph:
    """Return the interaction graph of the app that launch files start; nothing of it is run.

    Raise InputError if a given launch file cannot be read, or an argument is missing that it needs;
    what is wrong elsewhere stands in the graph's `unresolved`. Where the options allow it, a launch
    file that reading does not explain whole is run with the launch library (`executed`).
    """
    chosen, workspace = options or ScanOptions(), ros2_workspace(folders)
    files = WorkspaceFiles(workspace)
    read = _read(launches, environ, files, chosen.execution)
    started = StartedNodes(environ=environ)
    nodes = list(started.nodes([start for launch in read for start in launch.starts]))
    models = load_models(LIBRARY2)
    gazebo = GazeboServers(GazeboNodes(models, files), environ)
    assembly = Ros2Assembly(workspace=workspace)
    made = _made(read)
    with closing(_interpreting(workspace, chosen, models)) as interpreting:
        parts = list(interpreting.parts(nodes))
        assembly.note(*repeated(parts))
        parts += gazebo.nodes.parts(parts)
        parts += gazebo.parts(started.servers)
        controllers = list(ControllerNodes(models, files).parts(parts))
        own = interpreting.finished([part for part in controllers if part.task])
        for part in (*parts, *(part for part in controllers if not part.task), *own):
            assembly.add(with_known(part, files, made))
    assembly.note(*(note for launch in read for note in launch.unresolved))
    assembly.note(*started.notes.unresolved, *gazebo.notes.unresolved)
    return assembly.graph(Path(read[0].file).name.split(".")[0] if read else "")


def _interpreting(workspace: Workspace, chosen: ScanOptions, models: Models) -> Interpreting:
    state = workspace_state(workspace) if chosen.cache else ""
    return Interpreting(
        workspace=workspace,
        cache=open_cache(chosen.cache, state),
        pool=Pool(workspace, chosen.workers, chosen.seconds),
        progress=chosen.progress,
        models=models,
    )


def _read(
    launches: Sequence[Launch],
    environ: Mapping[str, str],
    files: WorkspaceFiles,
    execution: Execution | None,
) -> list[AppLaunch]:
    with deep_recursion():
        found = [read_app_launch(path, given, environ, files) for path, given in launches]
    for launch, (_, given) in zip(found, launches, strict=True):
        _check_arguments(launch, given)
    if execution:
        found = _executed(execution, found, launches, environ, files)
    for launch in found:
        _check_told(launch)
    return found


def _executed(
    execution: Execution,
    read: Sequence[AppLaunch],
    launches: Sequence[Launch],
    environ: Mapping[str, str],
    files: WorkspaceFiles,
) -> list[AppLaunch]:
    """Return the launches with those executed that reading leaves holes in."""
    return [
        with_lines(execution.launch(path, given, environ, files), launch)
        if leaves_open(launch)
        else launch
        for launch, (path, given) in zip(read, launches, strict=True)
    ]


def _made(read: Sequence[AppLaunch]) -> dict[str, YamlTree]:
    """Return the files that launches make, without those that two of them call the same."""
    trees = [(path, tree) for launch in read for path, tree in launch.made.items()]
    times = Counter(path for path, _ in trees)
    return {path: tree for path, tree in trees if times[path] == 1}


def _check_told(launch: AppLaunch) -> None:
    """Raise InputError for a launch file that tells nothing."""
    if launch.unresolved and not (launch.starts or launch.includes or launch.arguments):
        first = launch.unresolved[0]
        line = first.evidence[0].line if first.evidence else 0
        raise InputError(first.why, path=launch.file, line=line)


def _check_arguments(launch: AppLaunch, given: Mapping[str, str]) -> None:
    """Raise InputError where an argument is missing."""
    for argument in launch.arguments:
        if argument.default is None and argument.name not in given:
            place, help = argument.evidence, f"add {argument.name}:=VALUE"
            message = f"argument '{argument.name}' is not given"
            raise InputError(message, path=place.file, line=place.line, help=help)

"""An app in source: folders, the launch files in them, those that start it, and their environment.

A scan is the same on every machine: of the user's own environment only the folders of packages
count, and what `--env NAME` or `--env-all` asks for. The distribution is guessed from the
workspace where it is not given.
"""

import os
import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.errors import InputError
from rtron.sources.launch.common.environment import LaunchEnvironment
from rtron.sources.static.common.scan_options import Progress, ScanOptions
from rtron.sources.workspace.distro_guess import DistroGuess, guess_distro
from rtron.vocabulary import InteractionGraph, WiringFact, WiringFactKind

if TYPE_CHECKING:
    from rtron.sources.launch.common.launch_file import LaunchFileInfo
    from rtron.sources.workspace import Workspace

_INHERITED = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
_DISTRO = "ROS_DISTRO"
ASSIGNMENT = ":="


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceOptions:
    """The options that only an app in source has.

    Each of `launches` is a launch file with its own arguments, quoted as in a shell. `env`
    are variables as `given_environment` takes them, `env_all` takes all of the user's.
    `start_method` is that of ScanOptions.
    """

    launches: Sequence[str] = ()
    env: Sequence[str] = ()
    env_all: bool = False
    jobs: int | None = None
    use_cache: bool = True
    start_method: str | None = None

    @property
    def command_line(self) -> list[str]:
        """The words of a command line that choose the same app."""
        words = [word for launch in self.launches for word in ("--launch", launch)]
        return words + self.environment_options

    @property
    def environment_options(self) -> list[str]:
        """The words of a command line that give the same environment."""
        words = [word for each in self.env for word in ("--env", each)]
        return words + (["--env-all"] if self.env_all else [])


@dataclass(frozen=True, slots=True)
class WorkspaceSource:
    """A Source that scans folders for what launch files start."""

    folders: tuple[Path, ...]
    launches: tuple[tuple[Path, Mapping[str, str]], ...]
    environ: "LaunchEnvironment"
    options: ScanOptions
    workspace: "Workspace"
    ros: int = 1
    distro: "DistroGuess | None" = None

    def read(self) -> InteractionGraph:
        """Return the graph; raise InputError if a launch file cannot be read."""
        from rtron.sources.static.common.devices import with_devices  # noqa: PLC0415 - likewise
        from rtron.sources.static.common.unread_publishers import with_unread_publishers  # noqa: PLC0415 - likewise

        graph = with_unread_publishers(self._read(), self.workspace)
        graph = with_devices(graph, self.workspace)
        if self.ros > 1:
            from rtron.sources.static.ros2.state_publishers import with_state_publishers  # noqa: PLC0415 - only one is needed

            graph = with_state_publishers(graph, self.workspace)
        notes = dict.fromkeys((*graph.unresolved, *self.environ.notes()))
        wiring = (*graph.wiring, *self._distribution())
        return replace(graph, unresolved=tuple(notes), wiring=wiring)

    def _distribution(self) -> Iterator[WiringFact]:
        """Yield the distribution as a fact, if it was given and not guessed."""
        if self.distro is None and "ROS_DISTRO" in self.environ:
            yield WiringFact(kind=WiringFactKind.DISTRIBUTION, subject=self.environ["ROS_DISTRO"])

    def _read(self) -> InteractionGraph:
        if self.ros > 1:
            from rtron.sources.static.ros2.app import scan_ros2_app  # noqa: PLC0415 - only one is needed

            return scan_ros2_app(self.folders, self.launches, self.environ, self.options)
        from rtron.sources.static.ros1.app import scan_app  # noqa: PLC0415 - likewise

        return scan_app(self.folders, self.launches, self.environ, self.options).graph

    def descriptions(self, graph: InteractionGraph) -> Mapping[str, str]:
        """Return what the manifests of the packages say whose nodes are in a graph."""
        used = {node.package for node in graph.nodes} & self.workspace.packages.keys()
        return {package: self.workspace.manifest(package).description for package in used}


def open_workspace_source(
    folders: Sequence[Path], arguments: Sequence[str], options: SourceOptions, progress: Progress
) -> WorkspaceSource:
    """Return the app in source; raise InputError for a launch file that is not there."""
    from rtron.sources.launch.common.launch_file import launch_generation  # noqa: PLC0415 - the guard starts without it
    from rtron.sources.static.common.launch_paths import find_launch_file  # noqa: PLC0415 - likewise
    from rtron.sources.workspace import read_workspace  # noqa: PLC0415 - likewise

    if not options.launches:
        help = f"rtron scan {shlex.quote(str(folders[0]))} lists the launch files"
        raise InputError("--launch is missing", help=help)
    given = given_environment(options.env, take_all=options.env_all)
    workspace = read_workspace(folders, given)
    shared = parse_assignments(arguments)
    launch_lines = [_split_launch(launch) for launch in options.launches]
    launches = [
        (
            find_launch_file(spelled, workspace, given),
            {**shared, **parse_assignments(launch_arguments)},
        )
        for spelled, *launch_arguments in launch_lines
    ]
    ros = _single_generation({path: launch_generation(path) for path, _ in launches})
    environ, distro = launch_environment(given, folders, ros)
    return WorkspaceSource(
        tuple(folders),
        tuple(launches),
        environ,
        replace(
            static_scan_options(options.jobs, use_cache=options.use_cache, progress=progress),
            start_method=options.start_method,
        ),
        workspace,
        ros,
        distro,
    )


def source_folder(launch: Path) -> Path:
    """Return the folder to read with a launch file: its package's, or its own in none."""
    from rtron.sources.launch.common.packages import package_folder  # noqa: PLC0415 - likewise

    return package_folder(launch) or launch.absolute().parent


def static_scan_options(jobs: int | None, *, use_cache: bool, progress: Progress) -> ScanOptions:
    """Return how source is read: over `jobs` processes, by default all cores."""
    from rtron.sources.static.common.cache import user_cache_folder  # noqa: PLC0415 - the guard starts without it

    options = ScanOptions(cache=user_cache_folder() if use_cache else None, progress=progress)
    return replace(options, workers=jobs) if jobs else options


def _single_generation(generations: Mapping[Path, int]) -> int:
    """Return the ROS that all launch files are of; raise InputError where they differ."""
    first = {generation: path for path, generation in generations.items()}
    if len(first) > 1:
        message = f"{first[1].name} is of ROS 1 and {first[2].name} of ROS 2"
        raise InputError(message, help="scan the two apps apart: one --launch each")
    return next(iter(first))


def _split_launch(launch: str) -> list[str]:
    try:
        return shlex.split(launch) or [""]
    except ValueError as error:
        help = "quote the whole: --launch 'pkg/file.launch name:=value'"
        raise InputError(f"{launch}: {error}", help=help) from None


def launches_by_name(folders: Sequence[Path]) -> "dict[str, LaunchFileInfo]":
    """Return the launch files by name; those of a package that share a name, by path.

    Raise InputError for a folder that builds leave out.
    """
    from rtron.sources.launch.common.packages import require_no_ignore_marker  # noqa: PLC0415 - likewise
    from rtron.sources.launch.ros1.file_search import find_launch_files  # noqa: PLC0415 - likewise
    from rtron.sources.launch.ros2.file_search import list_ros2_launch_files  # noqa: PLC0415 - likewise

    require_no_ignore_marker(folders)
    found = {
        each.path: each for each in (*find_launch_files(folders), *list_ros2_launch_files(folders))
    }
    counted = Counter(map(_launch_name, found.values()))
    return {
        _launch_name(each) if counted[_launch_name(each)] == 1 else str(each.path): each
        for each in found.values()
    }


def _launch_name(launch: "LaunchFileInfo") -> str:
    """Return `package/file`, or the path of a file that lies in no package."""
    return f"{launch.package}/{launch.path.name}" if launch.package else str(launch.path)


def parse_assignments(arguments: Sequence[str]) -> dict[str, str]:
    """Return the values by name; raise InputError for an argument of another form."""
    for argument in arguments:
        if ASSIGNMENT not in argument or argument.startswith(ASSIGNMENT):
            help = "arguments are NAME:=VALUE, as for roslaunch"
            raise InputError(f"what is {argument!r}?", help=help)
    parts = (argument.partition(ASSIGNMENT) for argument in arguments)
    return {name: value for name, _, value in parts}


def given_environment(assignments: Sequence[str], *, take_all: bool) -> dict[str, str]:
    """Return the variables that count: `NAME=VALUE`, or `NAME` with its value here.

    Raise InputError for one of another form, or that is not set.
    """
    names = os.environ if take_all else [name for name in _INHERITED if name in os.environ]
    return {name: os.environ[name] for name in names} | dict(map(_pair, assignments))


def _pair(assignment: str) -> tuple[str, str]:
    name, equals, value = assignment.partition("=")
    if not name or name.endswith(":"):
        help = "write --env NAME=VALUE, or --env NAME for your own value"
        raise InputError(f"what is --env {assignment}?", help=help)
    if equals:
        return name, value
    if name not in os.environ:
        raise InputError(f"{name} is not set here", help=f"give its value: --env {name}=VALUE")
    return name, os.environ[name]


def robot_environment(given: Mapping[str, str]) -> LaunchEnvironment:
    """Return the environment of a launch that is to run: its distribution is no guess.

    It is the one that was given, or else that of the ROS which is sourced here.
    """
    sourced = {_DISTRO: os.environ[_DISTRO]} if _DISTRO in os.environ else {}
    return LaunchEnvironment({**sourced, **given})


def launch_environment(
    given: Mapping[str, str], folders: Sequence[Path], ros: int
) -> tuple[LaunchEnvironment, DistroGuess | None]:
    """Return the environment of a launch, with a guess at its distribution where none is given."""
    guess = None if _DISTRO in given else guess_distro(folders, ros)
    return LaunchEnvironment({_DISTRO: guess.name, **given} if guess else given), guess

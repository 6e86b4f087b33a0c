"""An app in source: folders, the launch files in them, and those that start it."""

import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.errors import InputError
from rtron.sources.static.common.scan_options import Progress, ScanOptions
from rtron.vocabulary import InteractionGraph, WiringFact, WiringFactKind
from rtron.workflows.launch_arguments import parse_assignments

if TYPE_CHECKING:
    from rtron.sources.launch.common.environment import LaunchEnvironment
    from rtron.sources.launch.common.launch_file import LaunchFileInfo
    from rtron.sources.workspace import Workspace
    from rtron.sources.workspace.distro_guess import DistroGuess


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
    from rtron.workflows.app_environment import given_environment, launch_environment  # noqa: PLC0415 - likewise

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

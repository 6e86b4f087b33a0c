"""Select the app to read: a graph, a bag, a running app, or source with launch files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shlex import quote

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.sources.bounded_file import STDIN
from rtron.sources.graph_json import GraphFile
from rtron.sources.source import GraphSource
from rtron.sources.static.common.scan_options import Progress, ignore_progress
from rtron.vocabulary import InteractionGraph
from rtron.workflows.launch_arguments import ASSIGNMENT
from rtron.workflows.live_app import LiveApp
from rtron.workflows.source_app import (
    SourceOptions,
    WorkspaceSource,
    open_workspace_source,
    source_folder,
)


@dataclass(frozen=True, slots=True)
class FunctionAnnotatedSource:
    """A Source whose nodes have their functions and domains, where these are known."""

    source: GraphSource

    def read(self) -> InteractionGraph:
        """Return the graph; manifests are looked at where the app is read from source."""
        from rtron.functions.node_functions import with_functions  # noqa: PLC0415 - only what is scanned needs it

        graph = self.source.read()
        if isinstance(self.source, WorkspaceSource):
            return with_functions(graph, self.source.descriptions(graph))
        return with_functions(graph)


@dataclass(frozen=True, slots=True)
class SelectedApp:
    """The source of an app, its description for people, and the arguments that select it again.

    For an app in source, `launches` are its launch files with their arguments, `root` is the folder
    above all its folders, and `guess` says what was guessed of it.
    """

    source: GraphSource
    description: str
    arguments: str
    root: Path | None = None
    launches: tuple[tuple[Path, Mapping[str, str]], ...] = ()
    guess: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class AppSelection:
    """The app that a person names: paths and launch arguments, or a running app."""

    inputs: Sequence[str]
    live: LiveApp | None
    source: SourceOptions

    @property
    def paths(self) -> list[Path]:
        """The words that are paths."""
        return [Path(argument) for argument in self.inputs if ASSIGNMENT not in argument]

    @property
    def launch_arguments(self) -> list[str]:
        """The words that are a launch file's arguments."""
        return [argument for argument in self.inputs if ASSIGNMENT in argument]

    @property
    def bag(self) -> Path | None:
        """The bag, if that is the only path; a folder with launch files is one of source."""
        sole = self.paths[0] if len(self.paths) == 1 else None
        if not sole or not _is_bag(sole) or (is_folder(sole) and self.source.launches):
            return None
        return sole

    @property
    def folders(self) -> list[Path]:
        """The folders, if the app is to be read from source; raise InputError for a mix."""
        if self.bag:
            return []
        folders = [path for path in self.paths if path != STDIN and is_folder(path)]
        if folders and len(folders) < len(self.paths):
            other = next(path for path in self.paths if path not in folders)
            help = "give folders with source, one graph, or one bag"
            raise InputError(f"{other} is not a folder", help=help)
        return folders


def with_launch_paths(selection: AppSelection) -> AppSelection:
    """Return a selection in which each path of a launch file is one of its `launches`.

    Without a folder beside them, the source is the packages that they lie in. What names no app in
    source, or two apps, stays as it is.
    """
    from rtron.sources.static.common.launch_paths import is_launch_file  # noqa: PLC0415 - only source needs it

    files = [path for path in selection.paths if path != STDIN and is_launch_file(path)]
    others = [path for path in selection.paths if path not in files]
    if not files or selection.live or not all(map(is_folder, others)):
        return selection
    folders = others or list(dict.fromkeys(map(source_folder, files)))
    launches = (*selection.source.launches, *(quote(str(path)) for path in files))
    return replace(
        selection,
        inputs=(*map(str, folders), *selection.launch_arguments),
        source=replace(selection.source, launches=launches),
    )


def select_app(selection: AppSelection, progress: Progress = ignore_progress) -> SelectedApp:
    """Return the selected app, whose nodes get their functions when it is read.

    `progress` is called while source is read. Raise InputError if no app is selected, or two are.
    """
    app = _select_app(selection, progress)
    return replace(app, source=FunctionAnnotatedSource(app.source))


def _select_app(selection: AppSelection, progress: Progress) -> SelectedApp:
    paths = selection.paths
    if paths and selection.live:
        help = "leave one of the two out"
        raise InputError(f"both {paths[0]} and --live are given", help=help)
    if selection.live:
        source, description = selection.live.open_source()
        return SelectedApp(source, description, selection.live.command_line)
    if selection.bag:
        return _bag_app(selection.bag, selection.source.launches)
    if selection.folders:
        return _source_app(selection, progress)
    if len(paths) > 1:
        raise InputError(
            f"what is {paths[1]}?", help="give one graph, one bag, or folders with source"
        )
    if paths:
        return _graph_file(paths[0])
    help = "give a PATH with --launch, a GRAPH.json, a bag, or --live for the running app"
    raise InputError("no app to read", help=help)


def _graph_file(graph: Path) -> SelectedApp:
    description = "standard input" if graph == STDIN else str(graph)
    return SelectedApp(
        GraphFile(graph), description, "GRAPH.json" if graph == STDIN else quote(str(graph))
    )


def _source_app(selection: AppSelection, progress: Progress) -> SelectedApp:
    source = open_workspace_source(
        selection.folders, selection.launch_arguments, selection.source, progress
    )
    arguments = [
        *map(str, selection.folders),
        *selection.launch_arguments,
        *selection.source.command_line,
    ]
    return SelectedApp(
        source,
        ", ".join(selection.source.launches),
        " ".join(map(quote, arguments)),
        root=_common_folder(selection.folders),
        launches=source.launches,
        guess=_distro_guess(source),
    )


def _distro_guess(source: WorkspaceSource) -> str:
    if source.distro is not None:
        return f"ROS_DISTRO={source.distro.name} is a guess, from {source.distro.file}"
    if source.ros == 1 or "ROS_DISTRO" in source.environ:
        return ""
    return "nothing names the ROS distribution: the newest counts; --env ROS_DISTRO=… gives it"


def _common_folder(folders: Sequence[Path]) -> Path | None:
    parents = [folder.absolute() for folder in folders]
    shared = [
        p for p in (parents[0], *parents[0].parents) if all(f.is_relative_to(p) for f in parents)
    ]
    return shared[0] if len(shared) > 1 else None


def _is_bag(path: Path) -> bool:
    from rtron.sources.bag.file_type import is_bag  # noqa: PLC0415 - only what is scanned is loaded

    return path != STDIN and is_bag(path)


def _bag_app(bag: Path, launches: Sequence[str]) -> SelectedApp:
    if launches:
        help = "leave one of the two out: a bag shows what ran, launch files what would run"
        raise InputError(f"both {bag} and --launch are given", help=help)
    from rtron.sources.bag.graph import BagSource  # noqa: PLC0415 - a graph needs no reader of bags

    return SelectedApp(BagSource(bag), str(bag), quote(str(bag)))

"""Which app a command is about: a graph, a bag, running, or source with launch files."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from shlex import quote

from rtron.cli.node_functions import WithFunctions
from rtron.cli.support.options import Ros
from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.sources.bounded_file import STDIN
from rtron.sources.graph_json import GraphFile
from rtron.sources.source import Source
from rtron.workflows.launch_arguments import ASSIGNED
from rtron.workflows.live_app import RunningApp
from rtron.workflows.source_app import StaticChoice, StaticSource, static_source


@dataclass(frozen=True, slots=True)
class App:
    """Where to read an app, how that is said, and the arguments that choose it."""

    source: Source
    said: str
    arguments: str
    root: Path | None = None
    launches: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Chosen:
    """What a command line says about the app: its words, and where it runs if that is wanted."""

    inputs: Sequence[str]
    running: RunningApp | None
    static: StaticChoice

    @property
    def paths(self) -> list[Path]:
        """The words that are paths."""
        return [Path(word) for word in self.inputs if ASSIGNED not in word]

    @property
    def arguments(self) -> list[str]:
        """The words that are a launch file's arguments."""
        return [word for word in self.inputs if ASSIGNED in word]

    @property
    def bag(self) -> Path | None:
        """The bag, if that is the only path; a folder with launch files is one of source."""
        sole = self.paths[0] if len(self.paths) == 1 else None
        if not sole or not _is_bag(sole) or (is_folder(sole) and self.static.launches):
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


def chosen_by(  # noqa: PLR0913 - one for each option
    inputs: Sequence[str] | None,
    launch: Sequence[str] | None,
    env: Sequence[str] | None,
    *,
    execute: bool,
    python: str | None,
    live: bool,
    ros: Ros,
    master: str,
    domain: int | None,
    timeout: float | None,
    jobs: int | None,
    no_cache: bool,
) -> Chosen:
    """Return what the options of a command about an app choose."""
    static = StaticChoice(
        launches=launch or (),
        env=env or (),
        jobs=jobs,
        use_cache=not no_cache,
        execute=execute,
        python=python,
    )
    running = RunningApp(ros=ros, master=master, domain=domain, timeout=timeout)
    return Chosen(inputs=inputs or (), running=running if live else None, static=static)


def chosen_app(chosen: Chosen) -> App:
    """Return the app that is chosen, its nodes with their functions.

    Raise InputError if none is chosen, or more than one.
    """
    app = _chosen_app(chosen)
    return replace(app, source=WithFunctions(app.source))


def _chosen_app(chosen: Chosen) -> App:
    paths = chosen.paths
    if chosen.static.execute and not chosen.folders:
        help = "give folders with source, and --launch"
        raise InputError("--execute-launch without an app in source", help=help)
    if paths and chosen.running:
        help = "leave one of the two out"
        raise InputError(f"both {paths[0]} and --live are given", help=help)
    if chosen.running:
        source, said = chosen.running.found()
        return App(source, said, chosen.running.arguments)
    if chosen.bag:
        return _recorded(chosen.bag, chosen.static.launches)
    if chosen.folders:
        return _static(chosen)
    if len(paths) > 1:
        raise InputError(
            f"what is {paths[1]}?", help="give one graph, one bag, or folders with source"
        )
    if paths:
        return _in_file(paths[0])
    help = "give a PATH with --launch, a GRAPH.json, a bag, or --live for the running app"
    raise InputError("no app to read", help=help)


def _in_file(graph: Path) -> App:
    said = "standard input" if graph == STDIN else str(graph)
    return App(GraphFile(graph), said, "GRAPH.json" if graph == STDIN else quote(str(graph)))


def _static(chosen: Chosen) -> App:
    source: StaticSource = static_source(chosen.folders, chosen.arguments, chosen.static)
    words = [*map(str, chosen.folders), *chosen.arguments, *chosen.static.words]
    return App(
        source,
        ", ".join(chosen.static.launches),
        " ".join(map(quote, words)),
        root=_common(chosen.folders),
        launches=tuple(str(path) for path, _ in source.launches),
    )


def _common(folders: Sequence[Path]) -> Path | None:
    parents = [folder.absolute() for folder in folders]
    shared = [
        p for p in (parents[0], *parents[0].parents) if all(f.is_relative_to(p) for f in parents)
    ]
    return shared[0] if len(shared) > 1 else None


def _is_bag(path: Path) -> bool:
    from rtron.sources.bag.file_type import is_bag  # noqa: PLC0415 - only what is scanned is loaded

    return path != STDIN and is_bag(path)


def _recorded(bag: Path, launches: Sequence[str]) -> App:
    if launches:
        help = "leave one of the two out: a bag shows what ran, launch files what would run"
        raise InputError(f"both {bag} and --launch are given", help=help)
    from rtron.sources.bag.graph import Bag  # noqa: PLC0415 - a graph needs no reader of bags

    return App(Bag(bag), str(bag), quote(str(bag)))

"""Which app a command is about: one in a graph file, or the one that is running."""

from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from rtron.errors import InputError
from rtron.sources.bounded import STDIN
from rtron.sources.graph_json import GraphFile
from rtron.sources.source import Source


@dataclass(frozen=True, slots=True)
class App:
    """Where to read an app, how that is said, and the arguments that choose it."""

    source: Source
    said: str
    arguments: str


def chosen_app(graph: Path | None, master: str | None, timeout: float) -> App:
    """Return the app in a graph file or, with a master's URI, the one that runs there.

    `timeout` is in seconds.
    """
    if graph and master:
        help = "leave one of the two out"
        raise InputError(f"both {graph} and --live are given", help=help)
    if master:
        return _running(master, timeout)
    if graph:
        said = "standard input" if graph == STDIN else str(graph)
        return App(GraphFile(graph), said, "GRAPH.json" if graph == STDIN else quote(str(graph)))
    raise InputError("no app to read", help="give a GRAPH.json, or --live for the running app")


def _running(master: str, timeout: float) -> App:
    from rtron.sources.ros1_live import Ros1Live  # noqa: PLC0415 - a file needs no ROS

    return App(Ros1Live(master, timeout), f"the app running at {master}", "--live")

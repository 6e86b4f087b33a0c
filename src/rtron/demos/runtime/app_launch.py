"""The app of a launch file, running: ROS 1 by roslaunch, ROS 2 node by node."""

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.runtime.app_files import other_packages, own_packages
from rtron.demos.runtime.nodes import NodeCommand, node_commands, node_names
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import Processes, Started
from rtron.errors import SourceError

if TYPE_CHECKING:
    from rtron.demos.runtime.environment import Begun

_SETTLED = ("--timeout", "3")
"""How long a domain of ROS 2 gets to be found whole, seconds."""
_VERDICTS = (0, 1, 2)


@dataclass(frozen=True, slots=True)
class App:
    """A running app: the processes that were started for it, by name, and its nodes."""

    started: Mapping[str, Started]
    nodes: Collection[str]

    def check(self) -> None:
        """Raise SourceError, with what it said last, if one of the processes has ended."""
        for started in self.started.values():
            started.check()


@contextmanager
def launched(
    begun: "Begun", launch: Path, more: Mapping[str, str], plan: Path | None
) -> Iterator[App]:
    """Run the app of a launch file; see Begun.launched."""
    commands, nodes = _what(begun, launch)
    started: dict[str, Started] = {}
    try:
        for each in commands:
            started[each.node] = _start(begun.processes, each, {**begun.environ, **more})
        app = App(started, nodes)
        if plan:
            wait_for(lambda: _is_guarded(begun, app, plan), "the guard to be in every way")
        else:
            wait_for(lambda: _is_joined(begun, app), f"the nodes {', '.join(sorted(app.nodes))}")
        yield app
    finally:
        begun.processes.end(tuple(started.values()))


def _what(begun: "Begun", launch: Path) -> tuple[Sequence[NodeCommand], Collection[str]]:
    """Return the commands that start an app, and the nodes that are there then."""
    folders = (own_packages(begun.ros), other_packages(begun.ros))
    if begun.ros == 1:
        nodes = node_names(launch, folders, begun.environ)
        return [NodeCommand("roslaunch", ("roslaunch", str(launch)))], nodes
    commands = node_commands(launch, folders, begun.environ, begun.python)
    return commands, {each.node for each in commands if each.is_of_app}


def _start(processes: Processes, what: NodeCommand, environ: Mapping[str, str]) -> Started:
    return processes.start(what.command, environ, name=what.node.strip("/").replace("/", "_"))


def _is_joined(begun: "Begun", app: App) -> bool:
    """Tell whether each node of the app publishes or subscribes something."""
    app.check()
    generation = ("--ros", str(begun.ros), *(_SETTLED if begun.ros != 1 else ()))
    words = ("scan", "--live", *generation, "--format", "graph", "--fail-on", "never")
    found = begun.folder / "joined.json"
    try:
        begun.rtron(*words, "-o", found)
    except SourceError:  # nobody has joined yet, or somebody is just leaving
        return False
    graph = json.loads(found.read_text(encoding="utf-8"))
    joined = {end["node"] for end in graph["endpoints"] if not end.get("implicit")}
    return joined.issuperset(app.nodes)


def _is_guarded(begun: "Begun", app: App, plan: Path) -> bool:
    """Tell whether the app is joined and every path of the plan is closed, asked at a time."""
    words = ("verify", "--live", "--plan", plan, *_SETTLED)
    with begun.rtron_beside(*words, codes=_VERDICTS) as verified:
        return _is_joined(begun, app) and verified().code == 0

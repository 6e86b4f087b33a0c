"""The app of a launch file, running: ROS 1 by roslaunch, ROS 2 node by node."""

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.demos.runtime.app_files import first_party_packages, third_party_packages
from rtron.demos.runtime.nodes import NodeCommand, node_commands, node_names
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import ProcessGroup, StartedProcess
from rtron.errors import SourceError

if TYPE_CHECKING:
    from rtron.demos.runtime.environment import DemoEnvironment

_DISCOVERY_OPTIONS = ("--timeout", "3")
"""How long a domain of ROS 2 gets to be found whole, seconds."""
_VERDICTS = (0, 1, 2)


@dataclass(frozen=True, slots=True)
class LaunchedApp:
    """A running app: the processes that were started for it, by name, and its nodes."""

    started: Mapping[str, StartedProcess]
    nodes: Collection[str]

    def check(self) -> None:
        """Raise SourceError, with what it said last, if one of the processes has ended."""
        for started in self.started.values():
            started.check()


@contextmanager
def launch_app(
    environment: "DemoEnvironment", launch: Path, more_environ: Mapping[str, str], plan: Path | None
) -> Iterator[LaunchedApp]:
    """Run the app of a launch file; see Begun.launched."""
    commands, nodes = _launch_commands(environment, launch)
    started: dict[str, StartedProcess] = {}
    try:
        for each in commands:
            started[each.node] = _start_node(
                environment.processes, each, {**environment.environ, **more_environ}
            )
        app = LaunchedApp(started, nodes)
        if plan:
            wait_for(lambda: _is_guarded(environment, app, plan), "the guard to be in every way")
        else:
            wait_for(
                lambda: _is_joined(environment, app), f"the nodes {', '.join(sorted(app.nodes))}"
            )
        yield app
    finally:
        environment.processes.end(tuple(started.values()))


def _launch_commands(
    environment: "DemoEnvironment", launch: Path
) -> tuple[Sequence[NodeCommand], Collection[str]]:
    """Return the commands that start an app, and the nodes that are there then."""
    folders = (first_party_packages(environment.ros), third_party_packages(environment.ros))
    if environment.ros == 1:
        nodes = node_names(launch, folders, environment.environ)
        return [NodeCommand("roslaunch", ("roslaunch", str(launch)))], nodes
    commands = node_commands(launch, folders, environment.environ, environment.python)
    return commands, {each.node for each in commands if each.is_of_app}


def _start_node(
    processes: ProcessGroup, node_command: NodeCommand, environ: Mapping[str, str]
) -> StartedProcess:
    return processes.start(
        node_command.command, environ, name=node_command.node.strip("/").replace("/", "_")
    )


def _is_joined(environment: "DemoEnvironment", app: LaunchedApp) -> bool:
    """Tell whether each node of the app publishes or subscribes something."""
    app.check()
    generation = (
        "--ros",
        str(environment.ros),
        *(_DISCOVERY_OPTIONS if environment.ros != 1 else ()),
    )
    arguments = ("scan", "--live", *generation, "--format", "graph", "--fail-on", "never")
    found = environment.folder / "joined.json"
    try:
        environment.run_rtron(*arguments, "-o", found)
    except SourceError:  # nobody has joined yet, or somebody is just leaving
        return False
    graph = json.loads(found.read_text(encoding="utf-8"))
    joined = {end["node"] for end in graph["endpoints"] if not end.get("implicit")}
    return joined.issuperset(app.nodes)


def _is_guarded(environment: "DemoEnvironment", app: LaunchedApp, plan: Path) -> bool:
    """Tell whether the app is joined and every path of the plan is closed, asked at a time."""
    arguments = ("verify", "--live", "--plan", plan, *_DISCOVERY_OPTIONS)
    with environment.run_rtron_in_background(*arguments, codes=_VERDICTS) as verified:
        return _is_joined(environment, app) and verified().code == 0

"""The app of a launch file, running: ROS 1 by roslaunch, ROS 2 node by node."""

import json
import shlex
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.isolation import first_party_packages, third_party_packages
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import Command, ProcessGroup, StartedProcess
from rtron.errors import InputError, SourceError
from rtron.planning.instrument.common.guarded_launch import GUARD_SCRIPT
from rtron.planning.plan_file.loader import read_plan
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros1.reader import read_launch
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.vocabulary import GUARD_NODE, LaunchNode, build_streams, is_bridge_client


@dataclass(frozen=True, slots=True)
class NodeCommand:
    """The full name of what is started, and the command that starts it."""

    node: str
    command: tuple[str, ...]

    @property
    def is_of_app(self) -> bool:
        """Whether it is a node of the app, not the guard."""
        return self.node != GUARD_NODE


def node_names(launch: Path, folders: Sequence[Path], environ: Mapping[str, str]) -> frozenset[str]:
    """Return the names of the nodes that a ROS 1 launch file starts, without the guard."""
    tree = read_launch(launch, {}, find_packages(folders, environ), environ)
    return frozenset(node.name for node in tree.nodes()) - {GUARD_NODE}


def node_commands(
    launch: Path, folders: Sequence[Path], environ: Mapping[str, str], python: Path
) -> tuple[NodeCommand, ...]:
    """Return what starts the nodes of a launch file and its includes, the guard first.

    `folders` have the packages; `python` runs their scripts. InputError for what cannot be read.
    """
    packages = find_packages(folders, environ)
    tree = read_ros2_launch(launch, {}, environ, packages)
    guards = [node for node in tree.nodes() if node.name == GUARD_NODE]
    nodes = [node for node in tree.nodes() if node.name != GUARD_NODE]
    script = launch.with_suffix(".d") / GUARD_SCRIPT
    return (
        *(NodeCommand(guard.name, (str(script),)) for guard in guards),
        *(_command(node, packages, python) for node in nodes),
    )


def _command(node: LaunchNode, packages: Mapping[str, Path], python: Path) -> NodeCommand:
    if node.package not in packages:
        help = "the demo's packages lie in apps and apps/third_party"
        raise InputError(f"{node.name}: there is no package {node.package!r}", help=help)
    script = packages[node.package] / "scripts" / node.type
    space, _, name = node.name.rpartition("/")
    rules = [f"__node:={name}", f"__ns:={space or '/'}"]
    rules += [f"{remap.written_source}:={remap.written_target}" for remap in node.remaps]
    ros = [word for rule in rules for word in ("-r", rule)]
    return NodeCommand(
        node.name, (str(python), str(script), *shlex.split(node.args), "--ros-args", *ros)
    )


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
    environment: DemoEnvironment,
    launch: Path,
    more_environ: Mapping[str, str] | None = None,
    plan: Path | None = None,
) -> Iterator[LaunchedApp]:
    """Run the app of a launch file until the end of the block, which starts when all nodes run.

    `more_environ` is added to the environment. With `plan` the block also waits until every path
    of that plan is closed. An attack that was armed is disarmed.
    """
    environment.arm_attack("none", 0)
    commands, nodes = _launch_commands(environment, launch)
    started: dict[str, StartedProcess] = {}
    try:
        for each in commands:
            started[each.node] = _start_node(
                environment.processes, each, {**environment.environ, **(more_environ or {})}
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
    environment: DemoEnvironment, launch: Path
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


def _is_joined(environment: DemoEnvironment, app: LaunchedApp) -> bool:
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


def _is_guarded(environment: DemoEnvironment, app: LaunchedApp, plan: Path) -> bool:
    """Tell whether the app is joined and every path of the plan is closed.

    The clients of a bridge come later.
    """
    publishers = {flow.publisher for each in build_streams(read_plan(plan)) for flow in each.flows}
    clients = [f"--absent={node}" for node in publishers if is_bridge_client(node)]
    arguments: Command = ["verify", "--live", "--plan", plan, *clients, *_DISCOVERY_OPTIONS]
    if not _is_joined(environment, app):
        return False
    return environment.run_rtron(*arguments, codes=_VERDICTS).code == 0

"""What a launch of ROS 2 starts, as the nodes that are to be interpreted.

docs.ros.org: launch_ros, "Composing multiple nodes in a single process"; rcl: arguments.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.code.library_models.rclcpp.component_manager import MANAGER
from rtron.sources.declaration import Loading, NodeSite, ParameterSetting
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.result import Start, StartKind
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.unresolved import Notes
from rtron.sources.static.ros2.gazebo_server import gazebo_server
from rtron.sources.static.ros2.processes import is_silent, joining
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import UNKNOWN

CONTAINERS = "rclcpp_components"


@dataclass(slots=True, kw_only=True)
class StartedNodes:
    """Makes the nodes of what launch files start; `environ` is that of the launch.

    `servers` are those of Gazebo among the processes.
    """

    environ: Mapping[str, str]
    servers: list[AppNode] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)

    def nodes(self, starts: Sequence[Start]) -> Iterator[AppNode]:
        """Yield nodes and components; a process that is not known is noted."""
        no_node = {StartKind.COMPONENT, StartKind.PROCESS}
        hosts = {_process_name(start): start for start in starts if start.kind not in no_node}
        for start in starts:
            if start.kind is StartKind.PROCESS:
                yield from self._process(start)
            elif start.kind is StartKind.COMPONENT:
                yield self._component(start, hosts.get(start.container))
            else:
                yield self._node(start)

    def _process(self, process: Start) -> Iterator[AppNode]:
        server, node = gazebo_server(process, self.environ), joining(process)
        words = process.arguments
        if server is not None:
            self.servers.append(server)
        elif node is not None:
            yield self._node(node)
        elif not is_silent(words):
            what = f"process {' '.join(words[:2])}"
            self.notes.add(what, "what it runs is not looked into", process.evidence)

    def _node(self, start: Start) -> AppNode:
        site = NodeSite(
            name=_name(start, _own_name(start)),
            ros=2,
            args=start.arguments,
            named=bool(start.name),
            placed=start.placed,
            complete=start.complete,
            environ=self._environ(start),
            settings=tuple(_settings(start.sources)),
            rules=start.remaps,
        )
        return _app_node(start, site, start)

    def _component(self, start: Start, host: Start | None) -> AppNode:
        """Return a component, which its container loads: the process is the container's."""
        if host is None:
            what, why = f"component {start.full_name}", "no launch file that is read starts it"
            self.notes.add(what, f"its container is {start.container}: {why}", start.evidence)
        site = NodeSite(
            name=_name(start, start.program.rpartition("::")[2]),
            ros=2,
            args=tuple(_words(start)),
            named=host is not None and bool(host.name),
            placed=host is not None and host.placed,
            complete=start.complete,
            environ=self._environ(host or start),
            settings=tuple(_settings(host.sources)) if host else (),
            rules=start.remaps,
            overrides=tuple((name, one.value) for name, one in start.parameters().items()),
            loading=Loading(
                container=start.container,
                known=host is not None and host.complete,
                options=tuple((name, one.value) for name, one in start.extra.items()),
            ),
        )
        return _app_node(start, site, host)

    def _environ(self, start: Start) -> tuple[tuple[str, str], ...]:
        return tuple({**self.environ, **dict(start.environ)}.items())


def _process_name(start: Start) -> str:
    return _name(start, _own_name(start))


def _name(start: Start, program: str) -> str:
    """Return a node's full name; one that names itself is mostly called like its program."""
    return start.full_name if start.name else canonical_name(f"{start.namespace}/{program}")


def _own_name(start: Start) -> str:
    """Return what a program mostly calls its node; a container's name is known."""
    return MANAGER if start.package == CONTAINERS else Path(start.program).stem


def _words(start: Start) -> Iterator[str]:
    """Yield the arguments in the options of a component (rclcpp_components: ComponentManager)."""
    own = [("__node", start.name)] if start.name and start.name != UNKNOWN else []
    own += [("__ns", start.namespace)] if start.placed else []
    yield "--ros-args"
    for name, target in (*own, *start.remaps):
        yield from ("-r", f"{name}:={target}")


def _settings(sources: Iterable[ParameterSource]) -> Iterator[ParameterSetting]:
    """Yield what is set, the last that fits counts: by each pattern's first place.

    So in both client libraries, as `rtron.sources.launch.ros2.parameters.merge` says.
    """
    gathered: dict[str, dict[str, ParameterSetting]] = {}
    for source in sources:
        for node, values in source.entries:
            of_node = gathered.setdefault(node if node.startswith("/") else f"/{node}", {})
            for name, found in values.items():
                of_node[name] = ParameterSetting(node=node, name=name, value=found.value)
    for of_node in gathered.values():
        yield from of_node.values()


def _app_node(start: Start, site: NodeSite, process: Start | None) -> AppNode:
    return AppNode(
        site=site,
        package=start.package,
        type=start.program,
        evidence=start.evidence,
        container=start.container,
        rules=process.remaps if process else (),
        doubtful=start.doubtful,
        executed=start.executed,
    )

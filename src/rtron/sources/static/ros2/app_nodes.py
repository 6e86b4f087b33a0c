"""What a launch of ROS 2 starts, as the nodes that are to be interpreted.

docs.ros.org: launch_ros, "Composing multiple nodes in a single process"; rcl: arguments.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.sources.code.library_models.rclcpp.node import DEFAULT_CONTAINER_NAME
from rtron.sources.declaration import ComponentLoading, NodeSite, ParameterSetting
from rtron.sources.launch.ros2.command_line import argument_remaps, special_remap
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.result import LaunchStart, StartKind
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.unresolved import UnresolvedList
from rtron.sources.static.ros2.gazebo_server import gazebo_server_node
from rtron.sources.static.ros2.loading_commands import (
    CONTAINER_PACKAGE,
    component_command,
    controller_command,
)
from rtron.vocabulary import Evidence
from rtron.vocabulary.enums import HiddenPart
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.parameters import absolute_pattern
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

_COMMANDS_WITHOUT_NODE = frozenset(
    {"gzclient", "sleep", "echo", "true", "cd", "source", ".", "export", "wait"}
)
"""Commands that join nothing; Gazebo's client draws the world."""
_ROS2 = "ros2"
_RVIZ = "rviz2"
_VERBS: Mapping[str, frozenset[str]] = {
    "topic": frozenset({"pub", "echo", "hz", "bw", "delay"}),
    "service": frozenset({"call"}),
    "action": frozenset({"send_goal"}),
    "lifecycle": frozenset({"set"}),
    "bag": frozenset({"play", "record"}),
}


def joins_nothing(command: Sequence[str]) -> bool:
    """Tell whether a command joins nothing; one that runs others in its words may."""
    runs_others = any("`" in word or "$(" in word for word in command)
    return not runs_others and Path("".join(command[:1])).name in {"", *_COMMANDS_WITHOUT_NODE}


def ros2_verb_node(process: LaunchStart) -> LaunchStart | None:
    """Return the node that a verb of `ros2` is, in a package called after its kind.

    None for another command.
    """
    program, kind, verb, *words = (*process.arguments, "", "", "")
    if Path(program).name != _ROS2 or verb not in _VERBS.get(kind, ()):
        return None
    return _as_node(process, f"{_ROS2}{kind}", verb, words[:-3])


def installed_program_node(process: LaunchStart) -> LaunchStart | None:
    """Return the node of a program that is run by its file; None for another command.

    ROS 2 installs a package's programs in `lib/PACKAGE` (REP 122); rviz2 is on the PATH, too.
    """
    program, words = Path("".join(process.arguments[:1])), process.arguments[1:]
    if program.name == _RVIZ:
        return _as_node(process, _RVIZ, _RVIZ, words)
    is_installed = program.parent.parent.name == "lib" and program.is_absolute()
    return _as_node(process, program.parent.name, program.name, words) if is_installed else None


def _as_node(process: LaunchStart, package: str, program: str, words: Sequence[str]) -> LaunchStart:
    """Return a process as the node that its command line makes."""
    remaps = tuple(argument_remaps(words))
    return replace(
        process,
        kind=StartKind.NODE,
        package=package,
        program=program,
        arguments=tuple(words),
        name=special_remap(words, "__node"),
        namespace=special_remap(words, "__ns") or "/",
        remaps=remaps,
    )


@dataclass(slots=True, kw_only=True)
class AppNodeBuilder:
    """Makes the nodes of what launch files start; `environ` is that of the launch.

    `gazebo_servers` are those of Gazebo among the processes.
    """

    environ: Mapping[str, str]
    gazebo_servers: list[AppNode] = field(default_factory=list)
    unresolved: UnresolvedList = field(default_factory=UnresolvedList)

    def build(self, starts: Sequence[LaunchStart]) -> Iterator[AppNode]:
        """Yield nodes and components; a process that is not known is noted."""
        no_node = {StartKind.COMPONENT, StartKind.PROCESS}
        containers = {process_name(start): start for start in starts if start.kind not in no_node}
        for start in starts:
            if start.kind is StartKind.PROCESS:
                yield from self._process(start, containers)
            elif start.kind is StartKind.COMPONENT:
                yield self._component(start, containers.get(start.container))
            else:
                yield self._node(start)

    def _process(
        self, process: LaunchStart, containers: Mapping[str, LaunchStart]
    ) -> Iterator[AppNode]:
        server = gazebo_server_node(process, self.environ)
        node = ros2_verb_node(process) or controller_command(process)
        node = node or installed_program_node(process)
        words, loaded = process.arguments, list(component_command(process))
        for container in loaded[:-1]:
            yield self._node(container)
        for component in loaded[-1:]:
            known = next(iter(loaded[:-1]), containers.get(component.container))
            yield self._component(component, known)
        if loaded:
            return
        if server is not None:
            self.gazebo_servers.append(server)
        elif node is not None:
            yield self._node(node)
        elif not joins_nothing(words):
            what = f"process {' '.join(words[:2])}"
            self.unresolved.add(what, "what it runs is not looked into", process.evidence)

    def _node(self, start: LaunchStart) -> AppNode:
        site = NodeSite(
            name=_name(start, _default_name(start)),
            ros=2,
            args=start.arguments,
            has_launch_name=bool(start.name),
            has_launch_namespace=start.has_namespace,
            parameters_complete=start.parameters_complete,
            environ=self._environ(start),
            settings=tuple(_parameter_settings(start.parameter_sources)),
            remap_rules=start.remaps,
        )
        return _app_node(start, site, start)

    def _component(self, start: LaunchStart, container: LaunchStart | None) -> AppNode:
        """Return a component, which its container loads: the process is the container's."""
        if container is None:
            what, why = f"component {start.full_name}", "no launch file that is read starts it"
            why = f"its container is {start.container}: {why}"
            self.unresolved.add(what, why, start.evidence, HiddenPart.NODES)
        site = NodeSite(
            name=_name(start, start.program.rpartition("::")[2]),
            ros=2,
            args=tuple(_component_arguments(start)),
            has_launch_name=container is not None and bool(container.name),
            has_launch_namespace=container is not None and container.has_namespace,
            parameters_complete=start.parameters_complete,
            environ=self._environ(container or start),
            settings=tuple(_parameter_settings(container.parameter_sources)) if container else (),
            remap_rules=start.remaps,
            overrides=tuple(
                (name, parameter.value) for name, parameter in start.parameters().items()
            ),
            loading=ComponentLoading(
                container=start.container,
                is_process_known=container is not None and container.parameters_complete,
                options=tuple(
                    (name, parameter.value) for name, parameter in start.extra_arguments.items()
                ),
            ),
        )
        return _app_node(start, site, container)

    def _environ(self, start: LaunchStart) -> tuple[tuple[str, str], ...]:
        return tuple({**self.environ, **dict(start.environ)}.items())


def process_name(start: LaunchStart) -> str:
    """Return the full name of what a launch starts; a program mostly calls its node like itself."""
    return _name(start, _default_name(start))


def _name(start: LaunchStart, program: str) -> str:
    """Return a node's full name; one that names itself is mostly called like its program."""
    return start.full_name if start.name else canonical_name(f"{start.namespace}/{program}")


def _default_name(start: LaunchStart) -> str:
    """Return what a program mostly calls its node; a container's name is known."""
    return (
        DEFAULT_CONTAINER_NAME if start.package == CONTAINER_PACKAGE else Path(start.program).stem
    )


def _component_arguments(start: LaunchStart) -> Iterator[str]:
    """Yield the arguments in the options of a component (rclcpp_components: ComponentManager)."""
    name_rules = [("__node", start.name)] if start.name and start.name != UNKNOWN_NAME else []
    name_rules += [("__ns", start.namespace)] if start.has_namespace else []
    yield "--ros-args"
    for name, target in (*name_rules, *start.remaps):
        yield from ("-r", f"{name}:={target}")


def _parameter_settings(sources: Iterable[ParameterSource]) -> Iterator[ParameterSetting]:
    """Yield what is set, the last that fits counts: by each pattern's first place.

    So in both client libraries, as `rtron.sources.launch.ros2.parameters.merge` says.
    """
    by_pattern: dict[str, dict[str, ParameterSetting]] = {}
    for source in sources:
        for node, values in source.entries:
            node_settings = by_pattern.setdefault(node if node.startswith("/") else f"/{node}", {})
            for name, parameter in values.items():
                node_settings[name] = ParameterSetting(node=node, name=name, value=parameter.value)
    for node_settings in by_pattern.values():
        yield from node_settings.values()


def _app_node(start: LaunchStart, site: NodeSite, process: LaunchStart | None) -> AppNode:
    return AppNode(
        site=site,
        package=start.package,
        type=start.program,
        evidence=start.evidence,
        container=start.container,
        process_remap_rules=process.remaps if process else (),
        is_uncertain=start.is_uncertain,
        parameter_places=_parameter_places(start.parameter_sources),
    )


def _parameter_places(sources: Iterable[ParameterSource]) -> dict[tuple[str, str], Evidence]:
    return {
        (absolute_pattern(pattern), name): parameter.evidence
        for source in sources
        for pattern, values in source.entries
        for name, parameter in values.items()
    }

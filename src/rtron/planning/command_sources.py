"""Which publisher of a command goes first until the developer says otherwise.

The kind of the source decides: an emergency stop, a person, a stage (a multiplexer, a smoother, a
collision monitor: what passes on what others command), autonomy (what serves actions, or works from
what it hears), a script that only speaks, a bridge to a network, and tools that show things last.
What a node reads, serves and carries tells its kind. Its name and function tell more only of nodes
that are yours: a name proves nothing, so it may put another's node behind others, never before
them. Among sources of one kind your own go before those of unknown origin, and these before third
parties'.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from itertools import groupby

from rtron.vocabulary import (
    Endpoint,
    FunctionType,
    InteractionGraph,
    Node,
    Trust,
    WiringFactKind,
    normalise_type,
    unstamped_type,
)
from rtron.vocabulary.names import EMERGENCY_STOP, snake_case
from rtron.vocabulary.ros_packages import CARRIER_PACKAGES, are_one_stack


class SourceKind(IntEnum):
    """The kinds of sources of commands; the first goes before the others."""

    EMERGENCY_STOP = 0
    PERSON = 1
    STAGE = 2
    AUTONOMY = 3
    SCRIPT = 4
    NETWORK = 5
    DISPLAY = 6


_TRUST = {Trust.OWN: 0, Trust.UNKNOWN: 1, Trust.THIRD_PARTY: 2}
_FUNCTIONS: Mapping[FunctionType | None, SourceKind] = {
    FunctionType.PATH_PLANNING: SourceKind.AUTONOMY,
    FunctionType.GOAL_PLANNER: SourceKind.AUTONOMY,
    FunctionType.PATH_TRACKING: SourceKind.AUTONOMY,
    FunctionType.TELEOPERATION: SourceKind.PERSON,
    FunctionType.VISUALIZATION: SourceKind.DISPLAY,
}
_PERSONAL = frozenset({"sensor_msgs/Joy", "visualization_msgs/InteractiveMarkerFeedback"})
"""What the hand of a person sends."""
_PERSONAL_PACKAGES = frozenset(
    {"teleop_twist_keyboard", "teleop_twist_joy", "joy_teleop", "key_teleop", "mouse_teleop"}
    | {"turtlebot3_teleop", "kobuki_keyop", "rqt_robot_steering", "rviz_2d_nav_goal"}
)
"""Packages whose nodes only send what a person does."""
_MOTIONS = ("Twist", "Ackermann", "JointTrajectory", "JointJog", "Wrench")
"""How the names of types begin that a stage passes on."""


@dataclass(frozen=True)
class CommandSources:
    """Orders the publishers of a graph.

    `servers` and `viewers` are the nodes that serve actions, and that show or record.
    """

    graph: InteractionGraph
    servers: Collection[str]
    viewers: Collection[str] = ()

    def sort(self, names: Iterable[str]) -> list[str]:
        """Return the nodes, the one that goes first at the front."""
        return sorted(names, key=lambda name: (*self._rank(name), name))

    def unordered(self, names: Iterable[str]) -> Iterator[tuple[str, ...]]:
        """Yield the nodes that their names alone order; those of one stack take turns anyway."""
        for _, equals in groupby(self.sort(names), self._rank):
            tied = tuple(equals)
            if not self.is_internal(tied):
                yield tied

    def is_guess(self, name: str) -> bool:
        """Return whether nothing tells what a node does."""
        return self._is_vague(name, self.kind(name)) and not self._node(name).function

    def is_internal(self, nodes: Iterable[str]) -> bool:
        """Return whether nodes are parts of one thing: of one process, or of one stack."""
        parts = [self._node(name) for name in nodes]
        is_one = len({node.process or node.name for node in parts}) == 1
        return bool(parts) and (is_one or are_one_stack([node.package for node in parts]))

    def kind(self, name: str) -> SourceKind:
        """Return the kind of a source: as observed, else by what its name and function tell."""
        node, observed = self._node(name), self._observed(name)
        if node.trust is Trust.OWN and EMERGENCY_STOP.search(snake_case(name)):
            return SourceKind.EMERGENCY_STOP
        function = _FUNCTIONS.get(node.function, observed)
        if not self._is_vague(name, observed):
            return observed
        return function if node.trust is Trust.OWN else max(function, observed)

    def _rank(self, name: str) -> tuple[SourceKind, int, bool]:
        return self.kind(name), _TRUST[self._node(name).trust], self.is_guess(name)

    def _is_vague(self, name: str, kind: SourceKind) -> bool:
        """Return whether a node only hears or speaks, which any node does."""
        return kind in {SourceKind.AUTONOMY, SourceKind.SCRIPT} and name not in self.servers

    def _observed(self, name: str) -> SourceKind:
        """Return the kind as far as the node's topics, actions and package tell."""
        package, types = self._node(name).package, self._subscribed_types(name)
        if name in self.viewers:
            return SourceKind.DISPLAY
        if package in CARRIER_PACKAGES:
            return SourceKind.NETWORK
        if package in _PERSONAL_PACKAGES or not types.isdisjoint(_PERSONAL):
            return SourceKind.PERSON
        if self._inputs(name):
            return self._carried(name)
        reacts = SourceKind.AUTONOMY if types else SourceKind.SCRIPT
        return SourceKind.AUTONOMY if name in self.servers else self._sockets.get(name, reacts)

    def _subscribed_types(self, name: str) -> frozenset[str]:
        subscriptions = (end for end in self.graph.subscribed_by(name) if not end.implicit)
        return frozenset(normalise_type(end.type) for end in subscriptions)

    def _carried(self, stage: str) -> SourceKind:
        """Return the kind of a stage: that of what it carries where this is of one kind.

        A smoother behind a joystick alone is a person, and one behind a script alone a script.
        """
        kinds = {self.kind(origin) for origin in self._origins(stage)}
        is_pure = len(kinds) == 1 and SourceKind.AUTONOMY not in kinds
        return kinds.pop() if is_pure else SourceKind.STAGE

    def _origins(self, stage: str) -> Iterator[str]:
        """Yield the nodes that no stage is, and whose commands come through one."""
        pending, seen = [stage], {stage}
        while pending:
            inputs = self._inputs(pending.pop())
            senders = {end.node for topic in inputs for end in self.graph.publishers(topic)} - seen
            seen |= senders
            for sender in sorted(senders):
                if self._inputs(sender):
                    pending.append(sender)
                else:
                    yield sender

    def _inputs(self, name: str) -> frozenset[str]:
        """Return the commands that a node hears and passes on; what its readers send is none."""
        outputs = _motions(self.graph.published_by(name))
        readers = {end.node for topic in outputs for end in self.graph.subscribers(topic)}
        inputs = _motions(self.graph.subscribed_by(name))
        alike = {topic for topic, type in inputs.items() if type in outputs.values()}
        senders = {
            t: {end.node for end in self.graph.publishers(t)} for t in alike - outputs.keys()
        }
        return frozenset(t for t, nodes in senders.items() if not nodes or nodes - readers)

    def _node(self, name: str) -> Node:
        return self._nodes.get(name, Node(name=name))

    @cached_property
    def _nodes(self) -> dict[str, Node]:
        return {node.name: node for node in self.graph.nodes}

    @cached_property
    def _sockets(self) -> dict[str, SourceKind]:
        """The nodes that join a network beside ROS: a page is for persons, the rest for anyone."""
        facts = (fact for fact in self.graph.wiring if fact.kind is WiringFactKind.SOCKET)
        web = {True: SourceKind.PERSON, False: SourceKind.NETWORK}
        return {fact.subject: web[fact.value == "web server"] for fact in facts}


def _motions(endpoints: Iterable[Endpoint]) -> dict[str, str]:
    """Return the topics whose type is a command that stages pass on, each with its type."""
    types = {e.topic: unstamped_type(normalise_type(e.type)) for e in endpoints if not e.implicit}
    return {t: type for t, type in types.items() if type.rpartition("/")[2].startswith(_MOTIONS)}

"""How commands go through an app: which topics reach hardware, and from which others they come.

What the source of a node was seen to do decides. Types and names say what may happen in nodes whose
source was not read, or whose callbacks could not be followed.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.node_roles import MOVING_HARDWARE, NodeRoles
from rtron.findings.inventory.program_flow import ProgramFlow
from rtron.findings.inventory.things import (
    COMMAND_NAMES,
    is_order,
    may_be_command,
    part_of_states,
    thing_of,
    thing_of_node,
)
from rtron.findings.measurement_names import MEASURED_TYPES, is_measured, may_be_measured
from rtron.findings.node_kinds import arbiters, priorities
from rtron.vocabulary import ActionRole, Direction, Domain, Ros1ActionTopic, normalise_type
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Means, Thing

TWIST = "geometry_msgs/Twist"
VAGUE = (Thing.DEVICE, Thing.MODE)
"""What a name may say without telling what moves."""
_HANDS = frozenset({"visualization_msgs/InteractiveMarkerFeedback"})
"""What a person does: with a joystick, and with a marker in a viewer."""
_SHOWN = re.compile(
    r"(?:tf2?|visualization|diagnostic|rosgraph|rcl_interfaces|map|stereo|rtcm|actionlib)_msgs/|std_msgs/Header"
    r"|sensor_msgs/CameraInfo"
)
"""Types of what is told of a robot, whoever hears it."""
_OF_ALL = re.compile(r"(?:std|geometry|sensor|nav|actionlib|action|trajectory)_msgs/")
"""Packages of types that are of no firmware in particular."""


@dataclass(frozen=True)
class AppFlow:
    """Tells of each topic who obeys it, who hands it on, and what it moves by its name."""

    app: AppFacts
    roles: NodeRoles
    _led: dict[tuple[str, str], frozenset[str]] = field(default_factory=dict, compare=False)

    @cached_property
    def programs(self) -> ProgramFlow:
        """What each node does with what it gets."""
        return ProgramFlow(self.app)

    @cached_property
    def ranks(self) -> dict[str, dict[str, str]]:
        """The priorities of the inputs of each arbiter."""
        return {node: priorities(self.app, node) for node in arbiters(self.app)}

    @cached_property
    def locks(self) -> frozenset[str]:
        """The topics that lock the inputs of an arbiter."""
        of_arbiters = (priorities(self.app, node, "locks") for node in self.ranks)
        return frozenset(topic for topics in of_arbiters for topic in topics)

    @cached_property
    def named(self) -> dict[str, Thing]:
        """The topics that type and name tell to move something, with what it is."""
        found = {topic: self._thing(topic) for topic in self._topics}
        return {topic: thing for topic, thing in found.items() if thing}

    def _thing(self, topic: str) -> Thing | None:
        """Return what a topic moves by type and name: what was measured, nothing."""
        if topic in self.locks or self.app.is_stop(topic):
            return Thing.STOP
        facts, type = self.app.facts, self.type(topic)
        is_ignored = facts.lists.ignores_topic(topic) or facts.lists.ignores_type(type)
        if is_ignored or facts.classify(topic).domain is Domain.PERCEPTION:
            return None
        is_obeyed = any(map(self.roles.may_obey, self.app.readers(topic)))
        if type.startswith(TWIST) and not is_obeyed and may_be_measured(topic):
            return None
        return thing_of(topic, type, Means.TOPIC)

    @cached_property
    def _topics(self) -> tuple[str, ...]:
        """The topics that are not of actions: these stand for them."""
        parts = [part.value for part in Ros1ActionTopic]
        actions = {f"{each.name}/{part}" for each in self.app.graph.actions for part in parts}
        return tuple(topic for topic in self.app.explicit_topics if topic not in actions)

    def type(self, topic: str) -> str:
        """Return a topic's type as ROS 1 spells it."""
        return normalise_type(self.app.facts.topic(topic).type)

    def is_by_hand(self, topic: str) -> bool:
        """Return whether a person sends a topic: by a joystick, or a marker of a viewer."""
        type = self.type(topic)
        return type in _HANDS or type.endswith("/Joy")

    @cached_property
    def obeying(self) -> dict[str, tuple[str, ...]]:
        """The topics that reach hardware, each with the nodes that obey it."""
        found = ((topic, tuple(self._ending(topic))) for topic in self._topics)
        return {topic: nodes for topic, nodes in found if nodes}

    def _ending(self, topic: str) -> Iterator[str]:
        is_report = self.is_report(topic)
        is_vague = is_report and self.named.get(topic) in {None, *VAGUE}
        for node in filter(self.roles.obeys, self.app.readers(topic)):
            is_seen = not is_vague and self._moves(node, topic)
            may_be_seen = not (is_report or self.roles.is_sensor(node))
            if is_seen or (may_be_seen and self._may_end(node, topic)):
                yield node

    def _moves(self, node: str, topic: str) -> bool:
        """Return whether a node is seen to move hardware by a topic.

        What was measured moves it if nothing else does. A library that is not known for hardware
        moves what the topic or its own name says.
        """
        way, type = self.programs.way(node, topic), self.type(topic)
        if way is not None and self.roles.is_sketch(node):
            return way.is_used
        if way is None or way.is_unknown:
            return False
        if way.device:
            is_feedback = self._is_measured(topic) and not self._only_measures(node, way.device)
            return not (is_feedback or _SHOWN.match(type))
        part = thing_of(topic, type, Means.TOPIC) or thing_of_node(way.library)
        is_part = part not in {None, *VAGUE}
        return bool(way.library) and is_part and not self._hands_on(node, topic)

    def _is_measured(self, topic: str) -> bool:
        """Return whether a type is of what was measured; joints may be moved by their states."""
        type = self.type(topic)
        return type != "sensor_msgs/JointState" and MEASURED_TYPES.match(type) is not None

    def _only_measures(self, node: str, device: str) -> bool:
        """Return whether a node moves motors, and only by what was measured."""
        ways = self.programs.ways[node].items()
        has_command = any(way.device for t, way in ways if not self._is_measured(t))
        offered = any(each.node == node and not each.implicit for each in self.app.graph.services)
        return device in MOVING_HARDWARE and not (has_command or offered)

    def _may_end(self, node: str, topic: str) -> bool:
        """Return whether a node may move hardware by a topic, though that is not seen.

        Its source was not read, or it opens hardware and leads a command nowhere else.
        """
        thing, way = self.named.get(topic), self.programs.way(node, topic)
        is_driver = self.roles.drives(node) or self.roles.is_called_driver(node)
        if part_of_states(topic, self.type(topic)) and self.roles.moves_hardware(node):
            is_sent = any(map(self.roles.drives, self.app.publishers(topic)))
            return not is_sent and (way is None or way.is_unknown)
        if way is not None and (not way.is_used or self._hands_on(node, topic)):
            return False
        if is_driver:
            is_beside = thing is None and may_be_command(topic, self.type(topic))
            return thing is not None or (is_beside and self._is_driving(node))
        if thing in {None, *VAGUE} or (way is None and not self.app.is_motion(topic)):
            return False
        if way is not None:
            return self.roles.may_drive(node)
        is_handed = any(self._may_hand_on(each, topic) for each in self.app.readers(topic))
        return not self._may_hand_on(node, topic) and (not is_handed or self.roles.may_drive(node))

    def _hands_on(self, node: str, topic: str) -> bool:
        """Return whether a node makes other commands of a topic, or may; a driver for others."""
        way = self.programs.way(node, topic)
        made = (way.led & self.named.keys() if way else set()) | self._made.get(node, set())
        is_driver = self.roles.drives(node)
        return any(not is_driver or self.app.readers(each) for each in made - {topic})

    def _is_driving(self, node: str) -> bool:
        """Return whether a node obeys a topic that says which part it moves."""
        moving = self._moving_inputs.get(node, frozenset())
        return any(self.named[topic] not in VAGUE for topic in moving)

    def _may_hand_on(self, node: str, topic: str) -> bool:
        """Return whether a node that was not followed sends commands that somebody else obeys."""
        return bool(self._made.get(node, frozenset()) - {topic})

    @cached_property
    def _made(self) -> dict[str, frozenset[str]]:
        """The commands that each node sends to others, or to nobody here."""
        called = {t for t in self.named if self.app.is_motion(t) or self.may_be_made(t)}
        hearing = {topic: {*self.app.readers(topic)} for topic in called}
        return {
            node: frozenset(t for t in topics & called if hearing[t] != {node})
            for node, topics in self._outputs.items()
        }

    def may_be_made(self, topic: str) -> bool:
        """Return whether a topic is called a command, or carries what firmware gets."""
        type = self.type(topic)
        is_own = not _OF_ALL.match(type) and not self.app.readers(topic)
        is_raw = type.endswith("MultiArray") or type.startswith("geometry_msgs/Wrench")
        is_called = COMMAND_NAMES.search(topic) is not None
        return is_raw or is_called or (is_own and bool(self.roles.firmware))

    def sent(self, node: str) -> frozenset[str]:
        """Return the topics that a node sends, those with a whole name."""
        return self._outputs.get(node, frozenset())

    @cached_property
    def _outputs(self) -> dict[str, frozenset[str]]:
        found = defaultdict[str, set[str]](set)
        for end in self.app.graph.endpoints:
            if end.direction is Direction.PUBLISH and not end.implicit and "{" not in end.topic:
                found[end.node].add(end.topic)
        return {node: frozenset(topics) for node, topics in found.items()}

    def is_report(self, topic: str) -> bool:
        """Return whether those alone send a topic that obey something else."""
        return topic in self._reports

    @cached_property
    def _reports(self) -> frozenset[str]:
        """What those alone send that obey something else, as drivers do."""
        return frozenset(filter(self._is_feedback, self._topics))

    def _is_feedback(self, topic: str) -> bool:
        senders = self.app.publishers(topic)
        chained = any(map(self.roles.is_controller, self.app.readers(topic)))
        return (
            bool(senders) and not chained and all(self._reports_motion(n, topic) for n in senders)
        )

    def _reports_motion(self, node: str, topic: str) -> bool:
        is_obeying = bool(self._moving_inputs.get(node, frozenset()) - {topic})
        ways = self.programs.ways.get(node, {})
        is_seen = any(way.device for other, way in ways.items() if other != topic)
        is_serving = node in self._servers and not self.app.is_motion(topic)
        is_driver = self.roles.drives(node) and (is_obeying or is_serving)
        return is_seen or is_driver or self.roles.is_controller(node)

    @cached_property
    def _moving_inputs(self) -> dict[str, frozenset[str]]:
        """The topics that each node hears and that say what they move."""
        moving = {topic for topic, thing in self.named.items() if thing not in NO_MOTION}
        return {node: topics & moving for node, topics in self._subscribed.items()}

    @cached_property
    def _servers(self) -> frozenset[str]:
        """The nodes that offer what moves something."""
        services = self.app.graph.services
        return frozenset(s.node for s in services if thing_of(s.name, s.type, Means.SERVICE))

    def led(self, node: str, topic: str) -> frozenset[str]:
        """Return what a node sends and calls because of a topic; where that is not seen, may."""
        if (node, topic) not in self._led:
            self._led[node, topic] = self._find_led(node, topic)
        return self._led[node, topic]

    def _find_led(self, node: str, topic: str) -> frozenset[str]:
        way = self.programs.way(node, topic)
        if way is not None and not way.is_lost:
            return way.led - {topic}
        may_tell = topic in self.named or self.is_by_hand(topic) or self._is_order(topic)
        if not may_tell or not self.roles.obeys(node) or node in self.obeying.get(topic, ()):
            return frozenset()
        sent = (t for t in self.sent(node) if t in self.named or self.is_by_hand(t))
        return frozenset(sent) - {topic} | self._requests.get(node, frozenset())

    def _is_order(self, topic: str) -> bool:
        type = self.type(topic)
        return type in SIGNALS or is_order(topic, type)

    @cached_property
    def _requests(self) -> dict[str, frozenset[str]]:
        """The services and actions that each node calls."""
        found = defaultdict[str, set[str]](set)
        graph = self.app.graph
        goals = ((e.node, e.name) for e in graph.actions if e.role is ActionRole.CLIENT)
        for node, name in (*((each.node, each.name) for each in graph.clients), *goals):
            found[node].add(name)
        return {node: frozenset(names) for node, names in found.items()}

    def inputs(self, node: str, commands: frozenset[str]) -> Iterator[str]:
        """Yield the topics by which a node is made to send or call some commands.

        What was measured, or tells how something moves, is none.
        """
        for topic in sorted(self._subscribed.get(node, frozenset()) - commands):
            type = self.type(topic)
            is_sensed = MEASURED_TYPES.match(type) or _SHOWN.match(type) or is_measured(topic)
            may_tell = self.is_by_hand(topic) or not (is_sensed or self._is_answer(topic))
            if may_tell and self.led(node, topic) & commands:
                yield topic

    def _is_answer(self, topic: str) -> bool:
        """Return whether those alone send a topic that obey commands: it tells how they do."""
        senders = self.app.publishers(topic)
        return self.is_report(topic) or (bool(senders) and self.obeying_nodes.issuperset(senders))

    @cached_property
    def _subscribed(self) -> dict[str, frozenset[str]]:
        """The topics that each node hears."""
        found = defaultdict[str, set[str]](set)
        for end in self.app.graph.endpoints:
            if end.direction is Direction.SUBSCRIBE:
                found[end.node].add(end.topic)
        return {node: frozenset(topics) for node, topics in found.items()}

    @cached_property
    def obeying_nodes(self) -> frozenset[str]:
        """The nodes that obey topics next to hardware."""
        return frozenset(node for nodes in self.obeying.values() for node in nodes)

    @cached_property
    def commands(self) -> frozenset[str]:
        """The commands of which somebody here obeys what they lead to."""
        found, level = set[str](), frozenset(self.obeying)
        while level:
            found |= level
            nodes = {node for topic in level for node in self.app.publishers(topic)}
            level = frozenset(t for node in nodes for t in self.inputs(node, level)) - found
        return frozenset(found)

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
from rtron.findings.inventory.node_roles import MOVING_HARDWARE, NodeRoles, may_drive_unread
from rtron.findings.inventory.program_flow import ProgramFlow
from rtron.findings.inventory.things import (
    COMMAND_NAMES,
    ORDERS,
    PARTS,
    is_order,
    may_be_command,
    part_of_states,
    thing_of,
    thing_of_node,
)
from rtron.findings.measurement_names import MEASURED_TYPES, is_measured, may_be_measured
from rtron.findings.node_kinds import arbiters, bridges, priorities
from rtron.vocabulary import ActionRole, Direction, Domain, Ros1ActionTopic, Trust, normalise_type
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Means, Thing
from rtron.vocabulary.names import snake_case

TWIST = "geometry_msgs/Twist"
_HANDS = frozenset({"visualization_msgs/InteractiveMarkerFeedback"})
"""What a person does: with a joystick, and with a marker in a viewer."""
_SHOWN = re.compile(
    r"(?:tf2?|visualization|diagnostic|rosgraph|rcl_interfaces|map|stereo|rtcm|actionlib)_msgs/|std_msgs/Header"
    r"|sensor_msgs/CameraInfo"
)
"""Types of what is told of a robot, whoever hears it."""
_MEASURABLE = re.compile(r"geometry_msgs/(?!Wrench)|(?:sensor|nav|actionlib|action|moveit)_msgs/")
"""Types that say more about what is measured or planned than about a command."""
_REPORTS = re.compile(
    r"error|debug|state|status|feedback|actual|measured|current|target|desired|reference"
    r"|(?:_|^)(?:closed|opened|reached|done|ok|ready)$"
)
"""Words in the names of what a controller tells of its work."""


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
        is_report = self._is_report(topic)
        is_vague = is_report and self.named.get(topic) in {None, *_VAGUE}
        for node in filter(self.roles.obeys, self.app.readers(topic)):
            is_seen = not is_vague and self._moves(node, topic)
            if is_seen or (not is_report and self._may_end(node, topic)):
                yield node

    def _moves(self, node: str, topic: str) -> bool:
        """Return whether a node is seen to move hardware by a topic.

        What was measured moves it if nothing else does. A library that is not known for hardware
        moves what the topic or its own name says.
        """
        way, type = self.programs.way(node, topic), self.type(topic)
        if way is None or way.is_unknown:
            return False
        if way.device:
            is_feedback = self._is_measured(topic) and not self._only_measures(node, way.device)
            return not (is_feedback or _SHOWN.match(type))
        part = thing_of(topic, type, Means.TOPIC) or thing_of_node(way.library)
        is_last = not way.led & self.named.keys()
        return bool(way.library) and is_last and part not in {None, *_VAGUE}

    def _is_measured(self, topic: str) -> bool:
        """Return whether a type is of what was measured; joints may be moved by their states."""
        type = self.type(topic)
        return type != "sensor_msgs/JointState" and MEASURED_TYPES.match(type) is not None

    def _only_measures(self, node: str, device: str) -> bool:
        """Return whether a node moves motors, and only by what was measured."""
        ways = self.programs.ways[node].items()
        is_told = any(way.device for topic, way in ways if not self._is_measured(topic))
        offered = any(each.node == node and not each.implicit for each in self.app.graph.services)
        return device in MOVING_HARDWARE and not (is_told or offered)

    def _may_end(self, node: str, topic: str) -> bool:
        """Return whether a node may move hardware by a topic, though that is not seen.

        Its source was not read, or it opens hardware and leads a command nowhere else.
        """
        if self.roles.is_sensor(node):
            return False
        thing, way = self.named.get(topic), self.programs.way(node, topic)
        is_driver = self.roles.drives(node) or self.roles.is_called_driver(node)
        if part_of_states(topic, self.type(topic)) and self.roles.moves_hardware(node):
            is_sent = any(map(self.roles.drives, self.app.publishers(topic)))
            return not is_sent and (way is None or way.is_unknown)
        if way is not None:
            is_lost = way.is_used and not way.led & self.named.keys()
            is_named = thing is not None and (thing not in _VAGUE or self.roles.drives(node))
            return is_named and is_lost and (is_driver or self.roles.may_drive(node))
        if is_driver:
            is_beside = thing is None and may_be_command(topic, self.type(topic))
            return thing is not None or (is_beside and self._is_driving(node))
        if not self.app.is_motion(topic) or thing in {None, *_VAGUE}:
            return False
        is_handed = any(self._may_hand_on(each, topic) for each in self.app.readers(topic))
        return not self._may_hand_on(node, topic) and (not is_handed or self.roles.may_drive(node))

    def _is_driving(self, node: str) -> bool:
        """Return whether a node obeys a topic that says which part it moves."""
        moving = self._moving_inputs.get(node, frozenset())
        return any(self.named[topic] not in _VAGUE for topic in moving)

    def _may_hand_on(self, node: str, topic: str) -> bool:
        """Return whether a node that was not followed sends commands that somebody else obeys."""
        return bool(self._made.get(node, frozenset()) - {topic})

    @cached_property
    def _made(self) -> dict[str, frozenset[str]]:
        """The commands that each node sends to others, or to nobody here."""
        called = {t for t in self.named if self.app.is_motion(t) or self._may_be_made(t)}
        hearing = {topic: {*self.app.readers(topic)} for topic in called}
        return {
            node: frozenset(t for t in topics & called if hearing[t] != {node})
            for node, topics in self._outputs.items()
        }

    def _may_be_made(self, topic: str) -> bool:
        """Return whether a topic is called a command, or carries what firmware gets."""
        is_raw = re.search(r"MultiArray$|geometry_msgs/Wrench", self.type(topic)) is not None
        return is_raw or COMMAND_NAMES.search(topic) is not None

    def _sent(self, node: str) -> frozenset[str]:
        return self._outputs.get(node, frozenset())

    @cached_property
    def _outputs(self) -> dict[str, frozenset[str]]:
        """The topics that each node sends, those with a whole name."""
        found = defaultdict[str, set[str]](set)
        for end in self.app.graph.endpoints:
            if end.direction is Direction.PUBLISH and not end.implicit and "{" not in end.topic:
                found[end.node].add(end.topic)
        return {node: frozenset(topics) for node, topics in found.items()}

    def _is_report(self, topic: str) -> bool:
        """Return whether those alone send a topic that obey something else, as a driver does."""
        return topic in self._reports

    @cached_property
    def _reports(self) -> frozenset[str]:
        return frozenset(filter(self._is_told, self._topics))

    def _is_told(self, topic: str) -> bool:
        senders = self.app.publishers(topic)
        chained = any(map(self.roles.is_controller, self.app.readers(topic)))
        return bool(senders) and not chained and all(self._tells(n, topic) for n in senders)

    def _tells(self, node: str, topic: str) -> bool:
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
        if way is not None and not way.is_unknown:
            return way.led - {topic}
        is_told = topic in self.named or self.is_by_hand(topic) or self._is_order(topic)
        if not is_told or not self.roles.obeys(node) or node in self.obeying.get(topic, ()):
            return frozenset()
        sent = (t for t in self._sent(node) if t in self.named or self.is_by_hand(t))
        return frozenset(sent) - {topic} | self._asked.get(node, frozenset())

    def _is_order(self, topic: str) -> bool:
        type = self.type(topic)
        return type in SIGNALS or is_order(topic, type)

    @cached_property
    def _asked(self) -> dict[str, frozenset[str]]:
        """The services and actions that each node calls."""
        found = defaultdict[str, set[str]](set)
        graph = self.app.graph
        goals = (each for each in graph.actions if each.role is ActionRole.CLIENT)
        for each in (*graph.clients, *goals):
            found[each.node].add(each.name)
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
        return self._is_report(topic) or bool(senders) and self._obeying_nodes.issuperset(senders)

    @cached_property
    def _subscribed(self) -> dict[str, frozenset[str]]:
        """The topics that each node hears."""
        found = defaultdict[str, set[str]](set)
        for end in self.app.graph.endpoints:
            if end.direction is Direction.SUBSCRIBE:
                found[end.node].add(end.topic)
        return {node: frozenset(topics) for node, topics in found.items()}

    @cached_property
    def leaving(self) -> frozenset[str]:
        """The commands that nobody here obeys: for firmware, or for another launch."""
        return frozenset(filter(self._leaves, self.named))

    def _leaves(self, topic: str) -> bool:
        """Return whether those send a topic to nobody here that command nothing else.

        Switches go to autopilots alone.
        """
        thing, senders = self.named[topic], self.app.publishers(topic)
        is_open = self.roles.firmware and self.app.is_motion(topic) and self.app.readers(topic)
        is_heard = any(self._hears(node, topic) for node in self.app.readers(topic))
        if is_heard or not (senders or is_open):
            return False
        if not is_of_autopilot(topic):
            is_vague = thing in _VAGUE and not any(map(thing_of_node, senders))
            may_move = self.app.is_motion(topic) or self._may_leave(topic)
            if is_vague or thing in NO_MOTION or not may_move:
                return False
        return not (topic in self.spare or any(self._only_tells(n, topic) for n in senders))

    @cached_property
    def spare(self) -> frozenset[str]:
        """The velocities that nobody here obeys, though drivers that were read obey others."""
        driven = {t for t, nodes in self.obeying.items() if any(map(self.roles.drives, nodes))}
        unread = set(self.app.unread_nodes).difference(bridges(self.app))
        may_obey = any(may_drive_unread(self.app.nodes[node]) for node in unread)
        velocities = {t for t in self.app.motion_topics if self.type(t).startswith(TWIST)}
        is_driven = not may_obey and bool(driven & velocities)
        return frozenset(velocities - self.obeying.keys() - self.heard if is_driven else ())

    def _may_leave(self, topic: str) -> bool:
        """Return whether nodes of one's own send what may order a part of the robot to move.

        It is no measurement, and the topic is called a command, or firmware may hear it.
        """
        type, thing = self.type(topic), self.named[topic]
        nodes = [self.app.nodes.get(name) for name in self.app.publishers(topic)]
        is_own = all(node and node.trust is Trust.OWN for node in nodes)
        is_called = not type.endswith("/String") and (thing in PARTS or self._may_be_made(topic))
        may_hear = bool(self.roles.firmware) or is_called
        return is_own and may_hear and not _MEASURABLE.match(type)

    def _hears(self, node: str, topic: str) -> bool:
        way = self.programs.way(node, topic)
        return self.roles.obeys(node) and (way is None or way.is_used)

    def _only_tells(self, node: str, topic: str) -> bool:
        """Return whether what a node sends to nobody here only tells how it works.

        So it is where it moves hardware itself, or commands others, or measures.
        """
        last = snake_case(topic.rpartition("/")[2])
        if self.roles.drives(node) or node in self._obeying_nodes:
            is_remote = node in self.roles.with_device and node not in self._obeying_nodes
            return not is_remote or thing_of(topic, "", Means.TOPIC) is None
        if self.roles.measures_motion(node, is_driver=False):
            return not COMMAND_NAMES.search(last)
        heard = self._sent(node) & self.heard - {topic}
        is_other = self.named[topic] in PARTS and self.named[topic] not in map(self.named.get, heard)
        return bool(_REPORTS.search(last) or (heard and not is_other))

    @cached_property
    def _obeying_nodes(self) -> frozenset[str]:
        return frozenset(node for nodes in self.obeying.values() for node in nodes)

    @cached_property
    def heard(self) -> frozenset[str]:
        """The commands of which somebody here obeys what they lead to."""
        found, level = set[str](), frozenset(self.obeying)
        while level:
            found |= level
            nodes = {node for topic in level for node in self.app.publishers(topic)}
            level = frozenset(t for node in nodes for t in self.inputs(node, level)) - found
        return frozenset(found)

    @cached_property
    def switches(self) -> frozenset[str]:
        """The topics that stop or release what others command, for nodes that hand these on."""
        found = filter(self._may_switch, self.named.keys() - self.heard)
        return self.locks.union(found)

    def _may_switch(self, topic: str) -> bool:
        thing, is_order = self.named[topic], self.type(topic) in ORDERS
        is_switch = thing in {Thing.STOP, Thing.ARMING} or (thing is Thing.POWER and is_order)
        return is_switch and any(self._hears(node, topic) for node in self.app.readers(topic))


_VAGUE = (Thing.DEVICE, Thing.MODE)
"""What a name may say without telling what moves."""
_AUTOPILOTS = ("/mavros/", "/dji_sdk/", "/fmu/in/")
"""Names of autopilots' topics and services: MAVROS, DJI's Onboard SDK, PX4 by uXRCE-DDS."""


def is_of_autopilot(name: str) -> bool:
    """Return whether a name is one of an autopilot's."""
    return any(each in name for each in _AUTOPILOTS)

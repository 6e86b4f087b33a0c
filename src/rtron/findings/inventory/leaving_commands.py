"""The commands that leave an app, as nobody in it obeys them; and the switches of commanders."""

import re
from dataclasses import dataclass
from functools import cached_property

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.app_flow import TWIST, VAGUE, AppFlow
from rtron.findings.inventory.node_roles import NodeRoles, may_drive_unread
from rtron.findings.inventory.things import COMMAND_NAMES, ORDERS, PARTS, thing_of, thing_of_node
from rtron.findings.node_kinds import bridges
from rtron.vocabulary import Trust
from rtron.vocabulary.inventory import NO_MOTION, Means, Thing
from rtron.vocabulary.names import snake_case

_MEASURABLE = re.compile(r"geometry_msgs/(?!Wrench)|(?:sensor|nav|actionlib|action|moveit)_msgs/")
"""Types that say more about what is measured or planned than about a command."""
_REPORTS = re.compile(
    r"error|debug|state|status|feedback|actual|measured|current|target|desired|reference"
    r"|(?:_|^)(?:closed|opened|reached|done|ok|ready)$"
)
"""Words in the names of what a controller tells of its work."""
_AUTOPILOTS = ("/mavros/", "/dji_sdk/", "/fmu/in/")
"""Names of autopilots' topics and services: MAVROS, DJI's Onboard SDK, PX4 by uXRCE-DDS."""


@dataclass(frozen=True)
class LeavingCommands:
    """Finds them by who sends them, and by what types and names tell."""

    app: AppFacts
    roles: NodeRoles
    flow: AppFlow

    @cached_property
    def topics(self) -> frozenset[str]:
        """The commands that nobody here obeys: for firmware, or for another launch."""
        return frozenset(filter(self._leaves, self.flow.named))

    def _leaves(self, topic: str) -> bool:
        """Return whether those send a topic to nobody here that command nothing else.

        Switches go to autopilots alone.
        """
        thing, senders = self.flow.named[topic], self.app.publishers(topic)
        is_open = self.roles.firmware and self.app.is_motion(topic) and self.app.readers(topic)
        is_obeyed = any(self._obeys(node, topic) for node in self.app.readers(topic))
        if is_obeyed or not (senders or is_open):
            return False
        if not is_of_autopilot(topic):
            is_vague = thing in VAGUE and not any(map(thing_of_node, senders))
            may_move = self.app.is_motion(topic) or self._may_leave(topic)
            if is_vague or thing in NO_MOTION or not may_move:
                return False
        return not (topic in self.spare or any(self._is_reporting(n, topic) for n in senders))

    @cached_property
    def spare(self) -> frozenset[str]:
        """The velocities that nobody here obeys, though drivers that were read obey others."""
        driven = {t for t, nodes in self.flow.obeying.items() if any(map(self.roles.drives, nodes))}
        unread = set(self.app.unread_nodes).difference(bridges(self.app))
        may_obey = any(may_drive_unread(self.app.nodes[node]) for node in unread)
        velocities = {t for t in self.app.motion_topics if self.flow.type(t).startswith(TWIST)}
        is_driven = not may_obey and bool(driven & velocities)
        return frozenset(
            velocities - self.flow.obeying.keys() - self.flow.commands if is_driven else ()
        )

    @cached_property
    def lost(self) -> frozenset[str]:
        """The velocities of which nodes make something else, not seen to reach hardware."""
        known = self.flow.commands | self.spare
        return frozenset(
            topic
            for topic in self.app.motion_topics
            if self.flow.type(topic).startswith(TWIST)
            and self.flow.named.get(topic) not in {None, *NO_MOTION}
            and not (topic in known or self.flow.is_report(topic))
            and any(self._makes_other(node, topic) for node in self.app.readers(topic))
        )

    def _makes_other(self, node: str, topic: str) -> bool:
        """Return whether a node makes of a topic what others hear, and no other velocity."""
        led = self.flow.led(node, topic)
        has_readers = any(map(self.app.readers, led))
        return self.roles.obeys(node) and has_readers and led.isdisjoint(self.app.motion_topics)

    def _may_leave(self, topic: str) -> bool:
        """Return whether nodes of one's own send what may order a part of the robot to move.

        It is no measurement, and the topic is called a command, or firmware may hear it.
        """
        type, thing = self.flow.type(topic), self.flow.named[topic]
        nodes = [self.app.nodes.get(name) for name in self.app.publishers(topic)]
        is_own = all(node and node.trust is Trust.OWN for node in nodes)
        is_called = not type.endswith("/String") and (
            thing in PARTS or self.flow.may_be_made(topic)
        )
        may_hear = bool(self.roles.firmware) or is_called
        return is_own and may_hear and not _MEASURABLE.match(type)

    def _obeys(self, node: str, topic: str) -> bool:
        way = self.flow.programs.way(node, topic)
        return self.roles.obeys(node) and (way is None or way.is_used)

    def _is_reporting(self, node: str, topic: str) -> bool:
        """Return whether what a node sends to nobody here only tells how it works.

        So it is where it moves hardware itself, or commands others, or measures.
        """
        last = snake_case(topic.rpartition("/")[2])
        if self.roles.drives(node) or node in self.flow.obeying_nodes:
            is_remote = node in self.roles.with_device and node not in self.flow.obeying_nodes
            return not is_remote or thing_of(topic, "", Means.TOPIC) is None
        if self.roles.measures_motion(node, is_driver=False):
            return not COMMAND_NAMES.search(last)
        others = self.flow.sent(node) & self.flow.commands - {topic}
        is_other = self.flow.named[topic] in PARTS and self.flow.named[topic] not in map(
            self.flow.named.get, others
        )
        return bool(_REPORTS.search(last) or (others and not is_other))

    @cached_property
    def switches(self) -> frozenset[str]:
        """The topics that stop or release what others command, for nodes that hand these on."""
        found = filter(self._may_switch, self.flow.named.keys() - self.flow.commands)
        return self.flow.locks.union(found)

    def _may_switch(self, topic: str) -> bool:
        thing, is_order = self.flow.named[topic], self.flow.type(topic) in ORDERS
        is_switch = thing in {Thing.STOP, Thing.ARMING} or (thing is Thing.POWER and is_order)
        return is_switch and any(self._obeys(node, topic) for node in self.app.readers(topic))


def is_of_autopilot(name: str) -> bool:
    """Return whether a name is one of an autopilot's."""
    return any(each in name for each in _AUTOPILOTS)

"""The commands that nobody in the app hears: they leave it, for firmware or another launch."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.derived_commands import REPORTS
from rtron.findings.inventory.node_roles import NodeRoles
from rtron.findings.inventory.things import may_be_command
from rtron.findings.measurement_names import may_be_measured
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Thing
from rtron.vocabulary.names import snake_case

_SETS = re.compile(r"^set_|_cmd$|_command$|^cmd_|^command_")
"""How the names of commands begin or end; `set` alone is vague."""
_ORDERS = re.compile(r"_(?:cmd|command|control)$")
"""How names end of what orders a part of a robot, in messages of one's own."""
_NUMBER = re.compile(r"std_msgs/(?:U?Int|Float)\d+")
_PARTS = frozenset({Thing.GRIPPER, Thing.TOOL, Thing.HEAD, Thing.THRUSTERS})
_TOOLS = _PARTS | {Thing.ARM}
_WHOLE = re.compile(r"std_msgs/U?Int\d+")
_OF_ALL = re.compile(r"(?:std|geometry|sensor|nav|actionlib|action|trajectory)_msgs/")
"""Packages of types that say more about what is measured or planned than about firmware."""


@dataclass(frozen=True)
class UnheardCommands:
    """Finds them by who sends them, and by the things that types and names tell."""

    app: AppFacts
    roles: NodeRoles
    things: Mapping[str, Thing | None]

    def leaves(self, topic: str) -> bool:
        """Return whether a number that moves something goes to nobody here.

        Its name says that it sets a part of the robot, or they alone send it that command motion.
        """
        type, senders = self.app.facts.topic(topic).type, self.app.publishers(topic)
        thing, last = self.things[topic], snake_case(topic.rpartition("/")[2])
        if topic in self.to_firmware or self.is_order(topic):
            return True
        if not self._is_moving(topic) or not self._is_unheard(topic):
            return False
        is_set = _SETS.search(last) and thing in _PARTS and _NUMBER.fullmatch(type)
        is_plain = type in SIGNALS and thing in _PARTS and "_" not in last
        is_number = _NUMBER.match(type) and not may_be_measured(topic)
        return bool(is_set or ((is_number or is_plain) and all(map(self.only_commands, senders))))

    def is_order(self, topic: str) -> bool:
        """Return whether a message of one's own, which nobody here obeys, orders a part to move."""
        last = snake_case(topic.rpartition("/")[2])
        is_own = _ORDERS.search(last) and not _OF_ALL.match(self.app.facts.topic(topic).type)
        return bool(is_own) and self.things[topic] in _TOOLS and self._is_unheard(topic)

    @cached_property
    def to_firmware(self) -> frozenset[str]:
        """The topics that nobody here hears, and that likely go to firmware of this launch."""
        topics = self.app.explicit_topics if self.roles.firmware else ()
        return frozenset(filter(self._may_reach_firmware, topics))

    def _may_reach_firmware(self, topic: str) -> bool:
        """Return whether what nobody here hears is sent as if to firmware.

        What the launch publishes once, numbers or messages of one's own that move something, or
        whole numbers beside commands, as those of buttons are.
        """
        type, senders = self.app.facts.topic(topic).type, self.app.publishers(topic)
        if "{" in topic or not self._is_unheard(topic) or not may_be_command(topic, type):
            return False
        is_moving = self._is_moving(topic)
        if is_moving and any(map(self.app.sends_once, senders)):
            return True
        if not all(map(self._hands_on, senders)):
            return False
        is_order = _WHOLE.fullmatch(type) and all(map(self.only_commands, senders))
        return bool(is_order or (is_moving and (_NUMBER.match(type) or not _OF_ALL.match(type))))

    def _hands_on(self, node: str) -> bool:
        """Return whether a node drives nothing, and sends or obeys commands of motion."""
        inputs = (end.topic for end in self.app.graph.subscribed_by(node))
        is_moved = any(map(self.app.is_motion, inputs)) and self.roles.obeys(node)
        return self.only_commands(node) or (is_moved and not self.roles.drives(node))

    def only_commands(self, node: str) -> bool:
        """Return whether a node commands motion and drives nothing itself."""
        sends = any(self._is_driving(end.topic) for end in self.app.graph.published_by(node))
        return sends and not self.roles.drives(node) and not self.roles.is_called_sensor(node)

    def _is_driving(self, topic: str) -> bool:
        """Return whether a topic commands motion, or a driver hears that it moves something."""
        is_obeyed = any(map(self.roles.is_called_driver, self.app.readers(topic)))
        return self.app.is_motion(topic) or (is_obeyed and self._is_moving(topic))

    def _is_moving(self, topic: str) -> bool:
        """Return whether type and name tell which part of a robot a topic moves."""
        return self.things.get(topic) not in {None, Thing.DEVICE, *NO_MOTION}

    def _is_unheard(self, topic: str) -> bool:
        """Return whether somebody sends a topic that nobody here hears, and that is no report."""
        is_report = REPORTS.search(snake_case(topic.rpartition("/")[2]))
        is_obeyed = any(map(self.roles.obeys, self.app.readers(topic)))
        return not (is_report or is_obeyed) and bool(self.app.publishers(topic))

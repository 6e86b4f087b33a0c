"""Which topics of an app may be commands, and what each of them moves."""

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.derived_commands import DerivedCommands
from rtron.findings.inventory.doors import has_door
from rtron.findings.inventory.message_flows import MessageFlows
from rtron.findings.inventory.node_roles import NodeRoles
from rtron.findings.inventory.things import (
    COMMAND_NAMES,
    ORDERS,
    may_be_command,
    may_switch,
    thing_of,
    thing_of_node,
)
from rtron.findings.inventory.unheard_commands import UnheardCommands
from rtron.findings.measurement_names import MEASURED_TYPES, may_be_measured
from rtron.findings.node_kinds import arbiters, priorities
from rtron.vocabulary import Direction, Domain, Endpoint, Ros1ActionTopic, normalise_type
from rtron.vocabulary.inventory import SIGNALS, Command, Means, Thing
from rtron.vocabulary.names import snake_case

_SURE_SWITCHES = frozenset({Thing.STOP, Thing.ARMING})
_SIGNAL_SWITCHES = _SURE_SWITCHES | {Thing.POWER}
_RELEASES = re.compile(
    r"^(?:control_)?(?:en|dis)able$|^(?:stop|cancel|abort)_|heart_?beat|keep_?alive|dead_?man"
)
"""Names of signals that stop what moves, or let it begin or go on."""
STOPPING = re.compile(r"(?:control_)?(?:stop|cancel|abort|disable)")
"""How the names of signals begin that stop what moves."""
_OF_BASE = re.compile(
    "drive|steer|wheel|base|chassis|omni|mecanum|ackermann|tricycle|bicycle", re.IGNORECASE
)
"""Words in the classes of controllers that move a base: beside an arm, others move that."""
TWIST = "geometry_msgs/Twist"
_JOY = "sensor_msgs/Joy"
_HANDS = frozenset({"visualization_msgs/InteractiveMarkerFeedback"})
"""What a person does: with a joystick, and with a marker in a viewer."""


@dataclass(frozen=True)
class CommandTopics:
    """The topics of an app that may command something, by their types, names and readers."""

    app: AppFacts
    roles: NodeRoles

    def command(self, topic: str, hops: int = 0) -> Command:
        """Return the command that a topic is."""
        facts, readers = self.app.facts.topic(topic), self._deriving.receivers(topic)
        return Command(
            means=Means.TOPIC,
            name=topic,
            type=facts.type,
            receivers=tuple(n for n in readers if not self.flows.is_unused(n, topic)),
            senders=facts.publishers,
            hops=hops,
        )

    def thing_of(self, topic: str) -> Thing:
        """Return what a topic moves; where it only says that it commands, what its nodes move."""
        if topic in self.locks or self.app.is_stop(topic):
            return Thing.STOP
        if topic in self.releases:
            is_end = STOPPING.match(snake_case(topic.rpartition("/")[2]))
            return Thing.STOP if is_end else Thing.ARMING
        thing = self._things.get(topic)
        if thing in {None, Thing.DEVICE}:
            thing = self.derived.get(topic, Thing.DEVICE)
        if thing is Thing.BASE and self._has_arm and self._moves_tool(topic):
            return Thing.ARM
        return thing if thing is not Thing.DEVICE else self._thing_of_nodes(topic) or thing

    def _thing_of_nodes(self, topic: str) -> Thing | None:
        """Return what the names tell of all that obey a topic, or of one that sends it."""
        obeying = set(map(thing_of_node, filter(self.roles.obeys, self.app.readers(topic))))
        sending = filter(None, map(thing_of_node, self.app.publishers(topic)))
        return obeying.pop() if len(obeying) == 1 and obeying != {None} else next(sending, None)

    @cached_property
    def _has_arm(self) -> bool:
        """Whether a controller of ros2_control moves an arm."""
        followed = (topic for topic, thing in self._things.items() if thing is Thing.ARM)
        return any(
            map(self.roles.is_controller, chain.from_iterable(map(self.app.readers, followed)))
        )

    def _moves_tool(self, topic: str) -> bool:
        """Return whether those that obey a topic are controllers of no base."""
        readers = self.app.readers(topic)
        programs = [self.app.nodes[node].executable for node in readers if node in self.app.nodes]
        is_controlled = bool(readers) and all(map(self.roles.is_controller, readers))
        return is_controlled and not any(map(_OF_BASE.search, programs))

    @cached_property
    def flows(self) -> MessageFlows:
        """What the messages lead to that nodes get."""
        return MessageFlows(self.app)

    @cached_property
    def ranks(self) -> dict[str, dict[str, str]]:
        """The priorities of the inputs of each arbiter."""
        return {node: priorities(self.app, node) for node in arbiters(self.app)}

    def passing_locks(self, nodes: Iterable[str]) -> list[str]:
        """Return the inputs of arbiters that their locks never hold back (twist_mux's README)."""
        found: list[str] = []
        for node in filter(self.ranks.__contains__, nodes):
            locks = priorities(self.app, node, "locks").values()
            ranked = {name: int(r) for name, r in self.ranks[node].items() if r.isdigit()}
            if locks and all(map(str.isdigit, locks)):
                found += (name for name, r in ranked.items() if r >= max(map(int, locks)))
        return found

    @cached_property
    def inputs(self) -> dict[str, tuple[str, ...]]:
        """What each node that commands motion is itself commanded by."""
        found: dict[str, set[str]] = defaultdict(set)
        for end in self.app.graph.endpoints:
            is_unused = self.flows.is_unused(end.node, end.topic)
            if end.direction is Direction.SUBSCRIBE and self._is_input(end) and not is_unused:
                found[end.node].add(end.topic)
        return {node: tuple(sorted(topics)) for node, topics in found.items()}

    def _is_input(self, end: Endpoint) -> bool:
        return self.is_by_hand(end.type) or self._may_command(end)

    def is_by_hand(self, type: str) -> bool:
        """Return whether a person sends a type: a joystick's, or a marker's of a viewer."""
        return type.endswith("/Joy") or normalise_type(type) in _HANDS

    @cached_property
    def _things(self) -> dict[str, Thing | None]:
        """What each topic moves, as far as type and name tell."""
        return {topic: self._thing(topic) for topic in self.app.explicit_topics}

    def _thing(self, topic: str) -> Thing | None:
        """Return what a topic moves: a velocity that a driver obeys is no measurement."""
        type = self.app.facts.topic(topic).type
        is_obeyed = any(map(self.roles.may_obey, self.app.readers(topic)))
        if normalise_type(type).startswith(TWIST) and not is_obeyed and may_be_measured(topic):
            return None
        return thing_of(topic, type, Means.TOPIC)

    @cached_property
    def unheard(self) -> UnheardCommands:
        """The commands that nobody here hears."""
        return UnheardCommands(self.app, self.roles, self._things)

    @cached_property
    def named_topics(self) -> frozenset[str]:
        """The topics that command motion, and what nodes with a device obey."""
        motion = {topic for topic in self.app.motion_topics if self._moves(topic)}
        motion |= set(filter(self._is_joy_command, self._things))
        found = (motion | self.locks | self.derived.keys()) - self._action_topics
        found |= set(filter(self.unheard.leaves, self._things))
        for node in filter(self.roles.obeys, filter(self.roles.is_called_driver, self.app.nodes)):
            found |= {e.topic for e in self.app.graph.subscribed_by(node) if self._may_command(e)}
        found |= set(filter(self._switches, self._things)) | self._pressed | self._written
        return frozenset(found | self.releases)

    @cached_property
    def _written(self) -> set[str]:
        """What nodes write to devices, whatever it is called; or, as it is called, to libraries."""
        inputs = (e for e in self.app.graph.endpoints if e.direction is Direction.SUBSCRIBE)
        return {end.topic for end in filter(self.is_unnamed, inputs) if self._is_output(end)}

    def moves_device(self, topic: str) -> bool:
        """Return whether who reads a topic is seen to write what it gets to a device."""
        given = (self.flows.outputs.get((node, topic)) for node in self.app.readers(topic))
        return topic in self._written and "device" in given

    def _is_output(self, end: Endpoint) -> bool:
        if self.roles.is_sketch(end.node):
            return not self.flows.is_unused(end.node, end.topic)
        given = self.flows.outputs.get((end.node, end.topic))
        is_named = self._things[end.topic] not in {None, Thing.DEVICE, Thing.MODE}
        if given == "device" and self.roles.is_actuating(end.node):
            return True
        if given is None or has_door(self.app, end.node):
            return False
        sent = (e.type for e in self.app.graph.published_by(end.node) if not e.implicit)
        is_last = all(MEASURED_TYPES.match(normalise_type(type)) for type in sent)
        return is_named and is_last and self.roles.obeys(end.node)

    @cached_property
    def _pressed(self) -> set[str]:
        """The signals that a driver gets from who commands its motion, whatever they are called."""
        motion = filter(self._moves, self.app.motion_topics)
        sides = (
            (s, r) for t in motion for s in self.app.publishers(t) for r in self.app.readers(t)
        )
        commanding = {(sender, reader) for sender, reader in sides if self.roles.drives(reader)}
        return {
            topic
            for topic in self.app.explicit_topics
            if self.app.facts.topic(topic).type in SIGNALS and may_switch(topic)
            for reader in self.app.readers(topic)
            if not self.flows.is_unused(reader, topic)
            and any((sender, reader) in commanding for sender in self.app.publishers(topic))
        }

    @cached_property
    def releases(self) -> frozenset[str]:
        """The signals by which those who command motion stop it, or begin."""
        return frozenset(filter(self._is_release, self.app.explicit_topics))

    def _is_release(self, topic: str) -> bool:
        last = snake_case(topic.rpartition("/")[2])
        if self.app.facts.topic(topic).type not in SIGNALS:
            return False
        named = (n for n in self.app.readers(topic) if last == snake_case(n.rpartition("/")[2]))
        readers = self.app.readers(topic) if _RELEASES.search(last) else named
        return any(map(self.unheard.only_commands, readers))

    @cached_property
    def derived(self) -> dict[str, Thing]:
        """What nodes make of the commands that their types and names tell, with what it moves."""
        known = {t: self._things[t] for t in self.app.motion_topics if not self.app.is_stop(t)}
        moving = {topic: thing for topic, thing in known.items() if thing}
        return self._deriving.find(moving)

    @cached_property
    def _deriving(self) -> DerivedCommands:
        return DerivedCommands(self.app, self.roles)

    def _is_joy_command(self, topic: str) -> bool:
        """Return whether a message of a joystick's type is a command by its name, as DJI's are."""
        is_named = COMMAND_NAMES.search(topic.rpartition("/")[2]) is not None
        return is_named and self.app.facts.topic(topic).type == _JOY and self._moves(topic)

    def _switches(self, topic: str) -> bool:
        """Return whether a topic that somebody obeys stops, arms or ends the robot."""
        is_signal = self.app.facts.topic(topic).type in ORDERS
        is_switch = self._things[topic] in (_SURE_SWITCHES if not is_signal else _SIGNAL_SWITCHES)
        is_state = self.app.facts.classify(topic).domain is Domain.PERCEPTION
        readers = self.app.readers(topic)
        is_mode = self._things[topic] is Thing.MODE and not self._switching.isdisjoint(readers)
        return (is_switch or (is_mode and is_signal)) and not is_state and bool(readers)

    @cached_property
    def _switching(self) -> frozenset[str]:
        """The nodes that call services which set a mode."""
        clients = self.app.graph.clients
        modes = (c for c in clients if thing_of(c.name, c.type, Means.SERVICE) is Thing.MODE)
        return frozenset(client.node for client in modes)

    def is_unnamed(self, end: Endpoint) -> bool:
        """Return whether a driver may obey a topic though neither its name nor its type tells."""
        is_explicit = not end.implicit and end.topic not in self._action_topics
        return is_explicit and may_be_command(end.topic, end.type)

    @cached_property
    def locks(self) -> frozenset[str]:
        """The topics that lock the inputs of an arbiter."""
        of_arbiters = (priorities(self.app, node, "locks") for node in arbiters(self.app))
        return frozenset(topic for topics in of_arbiters for topic in topics)

    @cached_property
    def _action_topics(self) -> frozenset[str]:
        """The topics that an action of ROS 1 has: the action stands for them."""
        parts = [part.value for part in Ros1ActionTopic]
        return frozenset(f"{each.name}/{part}" for each in self.app.graph.actions for part in parts)

    def _moves(self, topic: str) -> bool:
        return self._things.get(topic) is not None

    def _may_command(self, end: Endpoint) -> bool:
        """Return whether what a node sends or hears may move something."""
        facts = self.app.facts
        if end.implicit or end.topic in self._action_topics:
            return False
        if end.topic in self.derived:
            return True
        if facts.lists.ignores_topic(end.topic) or facts.lists.ignores_type(end.type):
            return False
        return facts.classify(end.topic).domain is not Domain.PERCEPTION and self._moves(end.topic)

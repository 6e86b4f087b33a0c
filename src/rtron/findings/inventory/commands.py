"""The commands of an app: what the nodes next to the hardware obey, and what leads there."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.node_roles import NodeRoles
from rtron.findings.inventory.requests import actions, services
from rtron.findings.inventory.things import may_be_command, thing_of, thing_of_node
from rtron.findings.motion.arbiter import arbiters, priorities
from rtron.vocabulary import (
    Direction,
    Domain,
    Endpoint,
    Ros1ActionTopic,
    normalise_type,
)
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, SWITCHES, Command, Means, Thing

_SURE_SWITCHES = frozenset({Thing.STOP, Thing.ARMING})
_SIGNAL_SWITCHES = _SURE_SWITCHES | {Thing.POWER}
_OF_VEHICLES = (Thing.BASE, Thing.ARM, Thing.DEVICE, Thing.THRUSTERS)
_COMMANDS = re.compile(r"cmd|command|setpoint|desired|_out$|^out")
_AUTOPILOTS = ("/mavros/", "/dji_sdk/", "/fmu/in/")
"""Names of autopilots' topics and services: MAVROS, DJI's Onboard SDK, PX4 by uXRCE-DDS."""
_ORDERS = SIGNALS | {"std_msgs/String"}
_JOY = "sensor_msgs/Joy"
_MOST_HOPS = 6


@dataclass(frozen=True)
class AppCommands:
    """The commands of an app, each with the thing that it moves."""

    app: AppFacts
    roles: NodeRoles
    _walks: dict[str, frozenset[str]] = field(default_factory=dict, init=False, compare=False)

    @cached_property
    def last(self) -> tuple[tuple[Thing, Command], ...]:
        """What is obeyed next to the hardware, or by nodes that are not in the app."""
        return tuple(chain(self._last_topics(), self._last_requests()))

    def _last_topics(self) -> Iterator[tuple[Thing, Command]]:
        for topic in self._command_topics:
            thing, command = self._thing_of_topic(topic), self.topic_command(topic)
            receivers = command.receivers
            is_vague = thing is Thing.DEVICE and receivers and self._drivers.isdisjoint(receivers)
            is_sent = command.senders and (thing not in SWITCHES or _is_of_autopilot(topic))
            has_sides = bool(receivers or is_sent) and not self._is_feedback(topic)
            if topic in self._locks or (
                has_sides and not (is_vague or self._is_forwarded(command))
            ):
                yield self._as_driven(thing, command)

    def _last_requests(self) -> Iterator[tuple[Thing, Command]]:
        graph = self.app.graph
        devices = {node for node in self.roles.with_device if not self.roles.is_sensor(node)}
        for thing, command in chain(
            services(graph, self._drivers, devices), actions(graph, self.app.facts.viewers)
        ):
            is_motor = thing is Thing.BASE and command.means is Means.SERVICE
            if not (is_motor and any(map(self.roles.is_sensor, command.receivers))):
                yield self._as_driven(thing, command)

    def _any_drives(self, nodes: Iterable[str]) -> bool:
        return any(map(self.roles.may_drive, nodes))

    def _as_driven(self, thing: Thing, command: Command) -> tuple[Thing, Command]:
        """Return what an autopilot moves as one vehicle: it does not tell what hangs on it."""
        receivers = command.receivers
        is_autopilot = (
            all(map(self.roles.is_autopilot, receivers))
            if receivers
            else _is_of_autopilot(command.name)
        )
        is_vehicle = thing in _OF_VEHICLES and is_autopilot
        return (Thing.VEHICLE if is_vehicle else thing), command

    def topic_command(self, topic: str, hops: int = 0) -> Command:
        """Return the command that a topic is."""
        facts = self.app.facts.topic(topic)
        return Command(
            means=Means.TOPIC,
            name=topic,
            type=facts.type,
            receivers=tuple(node for node in facts.successors if self.roles.obeys(node)),
            senders=facts.publishers,
            hops=hops,
        )

    def behind(self, commands: Iterable[Command]) -> Iterator[tuple[str, Command]]:
        """Yield each topic behind commands that leads to them, with the node that forwards it."""
        commands = tuple(commands)
        seen = {command.name for command in commands}
        nodes = dict.fromkeys(node for command in commands for node in command.senders)
        pending, visited = [(node, 1) for node in nodes], set(nodes)
        while pending:
            node, hops = pending.pop(0)
            ranks = self._ranks.get(node, {})
            for topic in () if self.roles.drives(node) else self._inputs.get(node, ()):
                if topic not in seen and not self._is_feedback(topic):
                    seen.add(topic)
                    found = self.topic_command(topic, hops)
                    yield node, replace(found, priority=ranks.get(topic, ""))
                    further = [n for n in found.senders if n not in visited and hops < _MOST_HOPS]
                    visited.update(further)
                    pending += [(each, hops + 1) for each in further]

    def _is_feedback(self, topic: str) -> bool:
        """Return whether those alone send a topic that drive and obey something else."""
        senders = self.app.publishers(topic)
        return bool(senders) and all(self._is_reporting(node, topic) for node in senders)

    def _is_reporting(self, node: str, topic: str) -> bool:
        """Return whether a driver obeys something, so that what it sends tells how it moves."""
        is_obeying = bool(set(self._inputs.get(node, ())) - {topic})
        return self.roles.is_controller(node) or (self.roles.drives(node) and is_obeying)

    def decides(self, node: str) -> bool:
        """Return whether a node decides between commands: an arbiter, or one that takes several."""
        return node in self._ranks or len(self._inputs.get(node, ())) > 1

    @cached_property
    def _ranks(self) -> dict[str, dict[str, str]]:
        """The priorities of the inputs of each arbiter."""
        return {node: priorities(self.app, node) for node in arbiters(self.app)}

    @cached_property
    def _inputs(self) -> dict[str, tuple[str, ...]]:
        """What each node that commands motion is itself commanded by."""
        found: dict[str, set[str]] = defaultdict(set)
        for end in self.app.graph.endpoints:
            if end.direction is Direction.SUBSCRIBE and self._is_input(end):
                found[end.node].add(end.topic)
        return {node: tuple(sorted(topics)) for node, topics in found.items()}

    def _is_input(self, end: Endpoint) -> bool:
        return normalise_type(end.type) == _JOY or self._may_command(end)

    @cached_property
    def _things(self) -> dict[str, Thing | None]:
        """What each topic moves, as far as type and name tell."""
        return {
            topic: thing_of(topic, self.app.facts.topic(topic).type, Means.TOPIC)
            for topic in self.app.explicit_topics
        }

    @cached_property
    def _named_topics(self) -> frozenset[str]:
        """The topics that command motion, and what nodes with a device obey."""
        motion = {topic for topic in self.app.motion_topics if self._moves(topic)}
        motion |= set(filter(self._is_joy_command, self._things))
        found = (motion | self._locks) - self._action_topics
        for node in filter(self.roles.is_called_driver, self.app.nodes):
            found |= {e.topic for e in self.app.graph.subscribed_by(node) if self._may_command(e)}
        return frozenset(found | set(filter(self._switches, self._things)))

    @cached_property
    def _command_topics(self) -> tuple[str, ...]:
        """The topics that command motion, and what else those hear that obey them."""
        endpoints = chain.from_iterable(map(self.app.graph.subscribed_by, self._drivers))
        unnamed = filter(self._is_unnamed_command, endpoints)
        return tuple(sorted(self._named_topics.union(each.topic for each in unnamed)))

    @cached_property
    def _drivers(self) -> frozenset[str]:
        """The nodes that obey commands of motion and hand none of them on."""
        found = set[str]()
        for topic in self._named_topics:
            command = self.topic_command(topic)
            last = [node for node in command.receivers if not self._forwards(node, command)]
            thing = self._thing_of_topic(topic)
            if thing is Thing.DEVICE:
                found.update(filter(self.roles.drives, last))
            elif thing not in NO_MOTION and len(last) == len(command.receivers):
                found.update(filter(self.roles.may_drive, last) if last[1:] else last)
        return frozenset(found)

    def _is_joy_command(self, topic: str) -> bool:
        """Return whether a message of a joystick's type is a command by its name, as DJI's are."""
        is_named = _COMMANDS.search(topic.rpartition("/")[2]) is not None
        return is_named and self.app.facts.topic(topic).type == _JOY and self._moves(topic)

    def _switches(self, topic: str) -> bool:
        """Return whether a topic that somebody obeys stops, arms or ends the robot."""
        is_signal = self.app.facts.topic(topic).type in _ORDERS
        is_switch = self._things[topic] in (_SURE_SWITCHES if not is_signal else _SIGNAL_SWITCHES)
        return is_switch and bool(self.app.readers(topic))

    def _is_unnamed_command(self, end: Endpoint) -> bool:
        """Return whether a driver may obey a topic though neither its name nor its type tells."""
        is_explicit = not end.implicit and end.topic not in self._action_topics
        return is_explicit and may_be_command(end.topic, end.type)

    @cached_property
    def _locks(self) -> frozenset[str]:
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
        if facts.lists.ignores_topic(end.topic) or facts.lists.ignores_type(end.type):
            return False
        return facts.classify(end.topic).domain is not Domain.PERCEPTION and self._moves(end.topic)

    def _thing_of_topic(self, topic: str) -> Thing:
        if topic in self._locks or self.app.is_stop(topic):
            return Thing.STOP
        thing = self._things.get(topic) or Thing.DEVICE
        nodes = (*self.app.publishers(topic), *self.app.readers(topic))
        named = filter(None, map(thing_of_node, nodes)) if thing is Thing.DEVICE else ()
        return next(iter(named), thing)

    def _is_forwarded(self, command: Command) -> bool:
        """Return whether those that obey a topic hand it on to others; the rest only listens."""
        rest = [node for node in command.receivers if not self._forwards(node, command)]
        return len(rest) < len(command.receivers) and not self._any_drives(rest)

    def _forwards(self, node: str, command: Command) -> bool:
        """Return whether a node makes another command of one, not only tells how it moves.

        What it sends goes further, and not back to who commands it.
        """
        if self.roles.drives(node):
            return False
        behind, obeying = (
            self._behind_nodes.get(node, Counter()),
            self._obedient.get(command.name, frozenset()),
        )
        is_sender = node in command.senders
        others = behind.keys() - self._upstream(command)
        return any(behind[each] > (is_sender and each in obeying) for each in others) or any(
            self._is_another(end, command) for end in self._unread_outputs.get(node, ())
        )

    def _is_another(self, end: Endpoint, command: Command) -> bool:
        """Return whether what nobody here obeys is a command made of one.

        Its type or name says so, or that an arbiter sends it.
        """
        if end.topic == command.name:
            return False
        is_same = normalise_type(end.type) == command.type
        is_named = _COMMANDS.search("/".join(end.topic.split("/")[-2:])) is not None
        return is_same or is_named or end.node in self._ranks

    @cached_property
    def _behind_nodes(self) -> dict[str, Counter[str]]:
        """Who may obey what each node sends, and how many topics of it."""
        found = defaultdict[str, Counter[str]](Counter)
        for node, topic in {(end.node, end.topic) for end in self._outputs}:
            found[node].update(self._obedient.get(topic, ()))
        return found

    @cached_property
    def _unread_outputs(self) -> dict[str, list[Endpoint]]:
        """What each node sends that nobody here obeys."""
        found = defaultdict[str, list[Endpoint]](list)
        for end in self._outputs:
            if not self._obedient.get(end.topic):
                found[end.node].append(end)
        return found

    @cached_property
    def _outputs(self) -> list[Endpoint]:
        """The endpoints that send command topics, or what nodes make them of."""
        sent = chain.from_iterable(map(self.app.graph.publishers, sorted(self._leading_topics)))
        return list(sent)

    @cached_property
    def _obedient(self) -> dict[str, frozenset[str]]:
        """Who may obey each topic."""
        obeys, readers = self.roles.obeys, self.app.readers
        topics = self.app.explicit_topics
        return {topic: frozenset(filter(obeys, readers(topic))) for topic in topics}

    def _upstream(self, command: Command) -> frozenset[str]:
        """Return the nodes that a command comes from, by themselves or through others."""
        if command.name not in self._walks:
            found, pending = set(command.senders), list(command.senders)
            while pending:
                further = self._sources.get(pending.pop(), frozenset()) - found
                found |= further
                pending += further
            self._walks[command.name] = frozenset(found)
        return self._walks[command.name]

    @cached_property
    def _sources(self) -> dict[str, frozenset[str]]:
        """Who sends what each node makes its commands of."""
        senders = self.app.publishers
        return {
            node: frozenset(chain.from_iterable(map(senders, topics)))
            for node, topics in self._inputs.items()
        }

    @cached_property
    def _leading_topics(self) -> frozenset[str]:
        """The command topics, and those that nodes make them of."""
        found, pending = set(self._named_topics), list(self._named_topics)
        while pending:
            for node in self.app.publishers(pending.pop()):
                further = set(self._inputs.get(node, ())) - found
                found |= further
                pending += further
        return frozenset(found)


def _is_of_autopilot(name: str) -> bool:
    return any(each in name for each in _AUTOPILOTS)

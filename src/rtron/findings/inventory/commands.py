"""The commands of an app: what the nodes next to the hardware obey."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.command_topics import TWIST, CommandTopics
from rtron.findings.inventory.forwarding import Forwarding
from rtron.findings.inventory.node_roles import NodeRoles, may_drive_unread
from rtron.findings.inventory.requests import actions, services
from rtron.findings.inventory.things import COMMAND_NAMES, PARTS, thing_of, thing_of_node
from rtron.findings.node_kinds import bridges
from rtron.vocabulary import ActionRole, Trust, normalise_type
from rtron.vocabulary.inventory import NO_MOTION, SWITCHES, Command, Means, Thing

_OF_VEHICLES = (Thing.BASE, Thing.ARM, Thing.DEVICE, Thing.THRUSTERS)
_SETPOINTS = ("desired_", "target_", "reference_", "commanded_")
"""How names begin of what a controller is to reach; it may tell of it, too."""
_AUTOPILOTS = ("/mavros/", "/dji_sdk/", "/fmu/in/")
"""Names of autopilots' topics and services: MAVROS, DJI's Onboard SDK, PX4 by uXRCE-DDS."""


@dataclass(frozen=True)
class AppCommands:
    """The commands of an app, each with the thing that it moves."""

    app: AppFacts
    roles: NodeRoles

    @cached_property
    def topics(self) -> CommandTopics:
        """The topics that may be commands."""
        return CommandTopics(self.app, self.roles)

    @cached_property
    def forwarding(self) -> Forwarding:
        """How commands go from node to node."""
        return Forwarding(self.topics)

    @cached_property
    def last(self) -> tuple[tuple[Thing, Command], ...]:
        """What is obeyed next to the hardware, or by nodes that are not in the app."""
        return tuple(chain(self._last_topics(), self._last_requests()))

    def _last_topics(self) -> Iterator[tuple[Thing, Command]]:
        for topic in self._command_topics:
            thing, command = self.topics.thing_of(topic), self.topics.command(topic)
            receivers = command.receivers
            is_vague = thing is Thing.DEVICE and receivers and self._drivers.isdisjoint(receivers)
            is_sent = bool(command.senders) and (thing not in SWITCHES or _is_of_autopilot(topic))
            is_sent |= bool(self.roles.firmware and self.app.readers(topic))
            is_command = self.topics.moves_device(topic) or not self._is_report(command)
            has_sides = bool(receivers or is_sent) and is_command and not self._is_operated(command)
            is_idle = is_vague or topic in self._unobeyed_velocities
            if topic in self.topics.locks | self.topics.releases or (
                has_sides and not (is_idle or self._is_forwarded(thing, command))
            ):
                yield from self._by_part(*self._as_driven(thing, command))

    def _is_report(self, command: Command) -> bool:
        """Return whether a topic tells how something moves, by its sides and its name."""
        is_feedback = self.forwarding.is_feedback(command.name)
        is_feedback &= not self.topics.unheard.is_order(command.name)
        return self._is_reading(command) or self._is_echo(command) or is_feedback

    @cached_property
    def _unobeyed_velocities(self) -> frozenset[str]:
        """The velocities that nobody here obeys, though the base does others that are alike."""
        velocities = (topic for topic in self._command_topics if self._is_velocity(topic))
        sides = {topic: self.topics.command(topic).receivers for topic in velocities}
        others = set(self.app.unread_nodes).difference(bridges(self.app))
        unread = (self.app.nodes[name] for name in others)
        is_driven = any(map(self.roles.drives, chain.from_iterable(sides.values())))
        if not is_driven or any(map(may_drive_unread, unread)):
            return frozenset()
        return frozenset(topic for topic, receivers in sides.items() if not receivers)

    def _is_velocity(self, topic: str) -> bool:
        is_twist = normalise_type(self.app.facts.topic(topic).type).startswith(TWIST)
        return is_twist and self.topics.thing_of(topic) is Thing.BASE

    def _leads_nowhere(self, node: str) -> bool:
        """Return whether a node commands by velocities alone that nobody obeys."""
        sent = {end.topic for end in self.app.graph.published_by(node)}
        commands = sent.intersection(self._command_topics)
        return bool(commands) and commands <= self._unobeyed_velocities

    def _by_part(self, thing: Thing, command: Command) -> Iterator[tuple[Thing, Command]]:
        """Yield a command for each part of the robot whose nodes are called like it, and the rest.

        A command that tells itself which part it moves is one.
        """
        parts = {node: thing_of_node(node) or thing for node in command.receivers}
        is_one = thing in PARTS or len(set(parts.values())) < 2  # noqa: PLR2004 - two differ
        for each in [thing] if is_one else sorted(set(parts.values())):
            nodes = tuple(node for node, part in parts.items() if is_one or part is each)
            yield each, replace(command, receivers=nodes)

    def _is_operated(self, command: Command) -> bool:
        """Return whether a person's joystick sends what no hardware here obeys: it is behind."""
        is_joystick = command.type.endswith("/Joy") and not COMMAND_NAMES.search(command.name)
        return is_joystick and not self._any_drives(command.receivers)

    def _is_reading(self, command: Command) -> bool:
        """Return whether what nobody here obeys is a reading: its senders measure their motion."""
        is_open = not command.receivers and not COMMAND_NAMES.search(command.name)
        is_named = thing_of(command.name, "", Means.TOPIC) is not None
        reads = self._is_measured if is_named else self._is_measured_or_driven
        return is_open and bool(command.senders) and all(map(reads, command.senders))

    def _is_echo(self, command: Command) -> bool:
        """Return whether nobody obeys a setpoint whose senders send others that are obeyed.

        So it is with a copy of the same command that has a time stamp.
        """
        last = command.name.rpartition("/")[2]
        is_echo = last.startswith(_SETPOINTS) or last.endswith("_stamped")
        is_open = is_echo and not command.receivers and bool(command.senders)
        return is_open and self._obeyed.issuperset(command.senders)

    @cached_property
    def _obeyed(self) -> frozenset[str]:
        """The nodes whose commands somebody here obeys."""
        commands = map(self.topics.command, self._command_topics)
        return frozenset(chain.from_iterable(c.senders for c in commands if c.receivers))

    def _is_measured_or_driven(self, node: str) -> bool:
        """Return whether a node measures its motion or makes it: it needs nobody to obey it."""
        return self.roles.is_actuating(node) or self._is_measured(node)

    def _is_measured(self, node: str) -> bool:
        is_driver = self.roles.drives(node) or node in self._drivers
        return self.roles.measures_motion(node, is_driver=is_driver)

    def _last_requests(self) -> Iterator[tuple[Thing, Command]]:
        graph = self.app.graph
        devices = {node for node in self.roles.beside_hardware if not self.roles.is_sensor(node)}
        drivers = self._drivers.union(filter(self.roles.is_controller, self.app.nodes))
        drivers |= self._called_hardware
        viewers = self.app.facts.viewers
        for thing, command in chain(
            services(graph, drivers | self._commanders, devices, viewers),
            actions(graph, self._active, viewers),
        ):
            is_dead = bool(command.receivers) and all(map(self._leads_nowhere, command.receivers))
            if not (is_dead or self._is_idle_service(thing, command)):
                yield self._as_driven(thing, command)

    @cached_property
    def _called_hardware(self) -> frozenset[str]:
        """The nodes with hardware that others call because they get a command of motion."""
        topics = self.topics.named_topics
        sides = ((node, topic) for topic in topics for node in self.app.readers(topic))
        names = set(chain.from_iterable(self.topics.flows.led(*side) for side in sides))
        servers = (each.node for each in self.app.graph.services if each.name in names)
        return frozenset(filter(self.roles.is_actuating, servers))

    def _is_idle_service(self, thing: Thing, command: Command) -> bool:
        """Return whether a service moves nothing, whatever its name says, by who offers it.

        A sensor turns a motor of its own. What neither drives nor commands anything only senses, or
        has a name that says little.
        """
        servers = command.receivers
        if command.means is not Means.SERVICE or not servers:
            return False
        if thing is Thing.BASE and any(map(self.roles.is_sensor, servers)):
            return True
        is_doubtful = thing is Thing.DEVICE or all(map(self.roles.is_called_sensor, servers))
        return is_doubtful and self._active.isdisjoint(servers)

    @cached_property
    def _commanders(self) -> frozenset[str]:
        """The app's own nodes that send commands: what they offer may change these."""
        commands = map(self.topics.command, self._command_topics)
        senders = set(chain.from_iterable(each.senders for each in commands))
        nodes = (node for node in self.app.graph.nodes if node.name in senders)
        own = (node.name for node in nodes if node.trust is Trust.OWN)
        return frozenset(name for name in own if not self.roles.is_called_sensor(name))

    @cached_property
    def _active(self) -> frozenset[str]:
        """The nodes that drive something, and those that command what does."""
        graph = self.app.graph
        senders = (node for t in self._command_topics for node in self.topics.command(t).senders)
        callers = (
            each.node
            for each in graph.clients
            if thing_of(each.name, each.type, Means.SERVICE) not in {None, Thing.DEVICE}
        )
        clients = (each.node for each in graph.actions if each.role is ActionRole.CLIENT)
        near = self.roles.beside_hardware.union(filter(self.roles.may_obey, self.app.nodes))
        devices = (node for node in near if not self.roles.is_called_sensor(node))
        return self._drivers.union(senders, callers, clients, devices, self.app.unread_nodes)

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

    @cached_property
    def _command_topics(self) -> tuple[str, ...]:
        """The topics that command motion, and what else those hear that obey them."""
        endpoints = chain.from_iterable(map(self.app.graph.subscribed_by, self._drivers))
        unnamed = filter(self.topics.is_unnamed, endpoints)
        return tuple(sorted(self.topics.named_topics.union(each.topic for each in unnamed)))

    @cached_property
    def _drivers(self) -> frozenset[str]:
        """The nodes that obey commands of motion and hand none of them on."""
        found = set[str]()
        for topic in self.topics.named_topics:
            command = self.topics.command(topic)
            last = [
                node for node in command.receivers if not self.forwarding.forwards(node, command)
            ]
            thing = self.topics.thing_of(topic)
            if thing is Thing.DEVICE:
                found.update(filter(self.roles.drives, last))
            elif thing not in NO_MOTION and len(last) == len(command.receivers):
                found.update(filter(self.roles.may_drive, last) if last[1:] else last)
        return frozenset(found)

    def _is_forwarded(self, thing: Thing, command: Command) -> bool:
        """Return whether those that obey a topic hand it on to others; the rest only listens.

        A stop is where it is asked for, if nobody here obeys what is made of it.
        """
        forwards, to_unread = self.forwarding.forwards, thing is not Thing.STOP
        rest = [n for n in command.receivers if not forwards(n, command, to_unread=to_unread)]
        return len(rest) < len(command.receivers) and not self._any_drives(rest)


def _is_of_autopilot(name: str) -> bool:
    return any(each in name for each in _AUTOPILOTS)

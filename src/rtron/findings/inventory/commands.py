"""The commands of an app: what moves hardware, what stands behind that, and what each moves."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.app_flow import AppFlow
from rtron.findings.inventory.forwarding import Forwarding
from rtron.findings.inventory.leaving_commands import LeavingCommands, is_of_autopilot
from rtron.findings.inventory.node_roles import MOVING_HARDWARE, NodeRoles
from rtron.findings.inventory.program_flow import Way
from rtron.findings.inventory.requests import actions, services
from rtron.findings.inventory.things import (
    PARTS,
    part_of_name,
    part_of_states,
    thing_of,
    thing_of_node,
)
from rtron.vocabulary import ActionRole, Service, Trust
from rtron.vocabulary.inventory import NO_MOTION, Command, Means, Thing

_OF_VEHICLES = (Thing.BASE, Thing.ARM, Thing.DEVICE, Thing.THRUSTERS)
_FAKE = "/fake_controller_joint_states"
"""What MoveIt sends where it only pretends to execute (package moveit_fake_controller_manager)."""
_SERVOS = frozenset({"servo driver", "servo bus"})
"""Hardware that turns joints: a velocity for it need not move a base."""
_OF_BASE = re.compile(
    "drive|steer|wheel|base|chassis|omni|mecanum|ackermann|tricycle|bicycle", re.IGNORECASE
)
"""Words in names of what moves a base: beside an arm, or by servos, others move that."""


@dataclass(frozen=True)
class AppCommands:
    """The commands of an app, each with the thing that it moves."""

    app: AppFacts
    roles: NodeRoles

    @cached_property
    def flow(self) -> AppFlow:
        """How commands go through the app."""
        return AppFlow(self.app, self.roles)

    @cached_property
    def forwarding(self) -> Forwarding:
        """What stands behind commands."""
        return Forwarding(self.app, self.roles, self.flow)

    @cached_property
    def _leaving(self) -> LeavingCommands:
        return LeavingCommands(self.app, self.roles, self.flow)

    @cached_property
    def last(self) -> tuple[tuple[Thing, Command], ...]:
        """What is obeyed next to the hardware, or by nodes that are not in the app."""
        return (*self._last_topics, *self._last_requests())

    @cached_property
    def _last_topics(self) -> tuple[tuple[Thing, Command], ...]:
        leaving = self._leaving
        topics = {*self.flow.obeying, *leaving.topics, *leaving.lost, *leaving.switches}
        commands = ((self.thing(topic), self.forwarding.command(topic)) for topic in sorted(topics))
        return tuple(chain.from_iterable(self._by_part(*self._as_driven(*c)) for c in commands))

    def thing(self, topic: str) -> Thing:
        """Return what a topic moves: what it says, else what its nodes and their hardware do."""
        type, nodes = self.flow.type(topic), self.flow.obeying.get(topic, ())
        thing = self.flow.named.get(topic) or thing_of(topic, type, Means.TOPIC)
        if thing is Thing.BASE and nodes and self._moves_joints(topic, nodes):
            return Thing.ARM if self._has_arm else Thing.SERVOS
        if thing and (thing in NO_MOTION or part_of_name(topic, type) not in {None, Thing.SERVOS}):
            return thing
        thing = thing or part_of_states(topic, type)
        obeying = {thing_of_node(node) for node in nodes}
        named = obeying.pop() if len(obeying) == 1 else None
        if named in {None, Thing.SERVOS}:
            thing = named if thing in {None, Thing.DEVICE} else thing
            parts = (p for p in self._parts_behind(topic) if not (thing and p is Thing.BASE))
            named = next(parts, thing)
        return named or Thing.DEVICE

    def _parts_behind(self, topic: str) -> Iterator[Thing]:
        """Yield which parts the topics behind one tell, its nodes and the libraries that get it."""
        behind = [
            command.name for _, command in self.forwarding.behind([self.forwarding.command(topic)])
        ]
        parts = {part for name in behind if (part := part_of_name(name, self.flow.type(name)))}
        yield from (each for each in Thing if each in parts)
        nodes = self.flow.obeying.get(topic, ())
        libraries = (way.library for n in nodes if (way := self.flow.programs.way(n, topic)))
        others = chain(nodes if len(nodes) == 1 else (), self.app.publishers(topic), libraries)
        yield from filter(None, (part_of_name(name, "") for name in others))

    def _moves_joints(self, topic: str, nodes: tuple[str, ...]) -> bool:
        """Return whether what obeys a velocity turns the joints of an arm, by its hardware."""
        if any(map(_OF_BASE.search, (topic, *nodes))):
            return False
        ways = (self.flow.programs.way(node, topic) for node in nodes)
        if any(way and way.device in _SERVOS for way in ways):
            return True
        programs = [self.app.nodes[node].executable for node in nodes if node in self.app.nodes]
        is_controlled = self._has_arm and all(map(self.roles.is_controller, nodes))
        return is_controlled and not any(map(_OF_BASE.search, programs))

    @cached_property
    def _has_arm(self) -> bool:
        """Whether a controller of ros2_control moves an arm."""
        followed = (topic for topic, thing in self.flow.named.items() if thing is Thing.ARM)
        nodes = chain.from_iterable(map(self.app.readers, followed))
        return any(map(self.roles.is_controller, nodes))

    def _by_part(self, thing: Thing, command: Command) -> Iterator[tuple[Thing, Command]]:
        """Yield a command for each part of the robot whose nodes are called like it, and the rest.

        A command that tells itself which part it moves is one.
        """
        parts = {node: thing_of_node(node) or thing for node in command.receivers}
        is_one = thing in PARTS or len(set(parts.values())) < 2  # noqa: PLR2004 - two differ
        for each in [thing] if is_one else sorted(set(parts.values())):
            nodes = tuple(node for node, part in parts.items() if is_one or part is each)
            yield each, replace(command, receivers=nodes)

    def _as_driven(self, thing: Thing, command: Command) -> tuple[Thing, Command]:
        """Return what an autopilot moves as one vehicle: it does not tell what hangs on it."""
        receivers = command.receivers
        is_autopilot = (
            all(map(self.roles.is_autopilot, receivers))
            if receivers
            else is_of_autopilot(command.name)
        )
        return (Thing.VEHICLE if thing in _OF_VEHICLES and is_autopilot else thing), command

    @cached_property
    def drivers(self) -> frozenset[str]:
        """The nodes that move hardware by topics, or may."""
        moving = (c for thing, c in self._last_topics if thing not in NO_MOTION)
        return frozenset(node for command in moving for node in command.receivers)

    @cached_property
    def commanders(self) -> frozenset[str]:
        """The app's own nodes that send commands: what they offer may change these."""
        sent = [command for _, command in self._last_topics]
        sent += [command for _, command in self.forwarding.behind(sent)]
        senders = {node for command in sent for node in command.senders} & self.app.nodes.keys()
        own = (name for name in senders if self.app.nodes[name].trust is Trust.OWN)
        return frozenset(name for name in own if not self.roles.is_called_sensor(name))

    def _last_requests(self) -> Iterator[tuple[Thing, Command]]:
        graph, viewers = self.app.graph, self.app.facts.viewers
        devices = {node for node in self.roles.beside_hardware if not self.roles.is_sensor(node)}
        drivers = self.drivers.union(filter(self.roles.is_controller, self.app.nodes))
        drivers |= {each.node for each in graph.services if self._is_written(each)}
        offered = services(graph, drivers | self.commanders, devices, viewers)
        for thing, command in chain(offered, actions(graph, self._active, viewers)):
            ways = [self.flow.programs.request(n, command.name) for n in command.receivers]
            seen = [way for way in ways if way is not None]
            is_idle = bool(seen) and len(seen) == len(ways) and not any(map(self._reaches, seen))
            is_idle |= bool(command.receivers) and all(map(self._leads_nowhere, command.receivers))
            if not (is_idle or self._is_idle_service(thing, command)):
                is_vague = thing in {Thing.DEVICE, Thing.BASE}
                moved = next(self._moved_by(command.receivers), thing) if is_vague else thing
                yield self._as_driven(moved, command)

    def _leads_nowhere(self, node: str) -> bool:
        """Return whether a node commands nobody: it pretends, or by velocities nobody obeys."""
        sent = {end.topic for end in self.app.graph.published_by(node)}
        if any(topic.endswith(_FAKE) for topic in sent):
            return True
        spare = sent & self._leaving.spare
        is_idle = bool(spare) and node not in self.drivers
        return is_idle and sent.isdisjoint((self.flow.commands | self._moving) - spare)

    def _moved_by(self, nodes: tuple[str, ...]) -> Iterator[Thing]:
        """Yield what nodes move by topics, or what those move that they command."""
        for thing, others in self._movers:
            if not others.isdisjoint(nodes):
                yield thing

    @cached_property
    def _movers(self) -> tuple[tuple[Thing, frozenset[str]], ...]:
        """What the last topics move, each with the nodes on the way there, nearest first."""
        moving = [each for each in self._last_topics if each[0] not in NO_MOTION]
        drivers = [(thing, frozenset(last.receivers)) for thing, last in moving]
        ways = (
            (thing, [c for _, c in self.forwarding.behind([last])], last) for thing, last in moving
        )
        others = [
            (thing, frozenset(last.senders).union(*(c.senders for c in behind)))
            for thing, behind, last in ways
        ]
        return (*drivers, *others)

    def _is_written(self, service: Service) -> bool:
        """Return whether a service writes to hardware for who calls it because of a command."""
        way = self.flow.programs.request(service.node, service.name)
        is_written = way.device if way else self.roles.is_actuating(service.node)
        return bool(is_written) and service.name in self._called

    @cached_property
    def _called(self) -> frozenset[str]:
        """What commands and people make nodes send and call."""
        ways = ((t, w) for each in self.flow.programs.ways.values() for t, w in each.items())
        told = (w.led for t, w in ways if t in self.flow.named or self.flow.is_by_hand(t))
        return frozenset(chain.from_iterable(told))

    def _reaches(self, way: Way) -> bool:
        """Return whether what a request leads to moves something, or may."""
        requests = {each.name for each in self.app.graph.clients}
        requests |= {each.name for each in self.app.graph.actions}
        is_sent = way.led & (self.flow.commands | self._moving | requests)
        return bool(is_sent or way.device or way.library)

    @cached_property
    def _moving(self) -> frozenset[str]:
        return frozenset(command.name for _, command in self._last_topics)

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
    def _active(self) -> frozenset[str]:
        """The nodes that drive something, and those that command what does."""
        graph = self.app.graph
        senders = (node for _, command in self._last_topics for node in command.senders)
        callers = (
            each.node
            for each in graph.clients
            if thing_of(each.name, each.type, Means.SERVICE) not in {None, Thing.DEVICE}
        )
        clients = (each.node for each in graph.actions if each.role is ActionRole.CLIENT)
        near = self.roles.beside_hardware.union(filter(self.roles.may_obey, self.app.nodes))
        devices = (node for node in near if not self.roles.is_called_sensor(node))
        return self.drivers.union(senders, callers, clients, devices, self.app.unread_nodes)

    def moves_at_start(self, node: str) -> bool:
        """Return whether a node is seen to turn motors or servos before it gets any command."""
        fact = self.flow.programs.moves_by_itself(node)
        return fact is not None and fact.value in MOVING_HARDWARE

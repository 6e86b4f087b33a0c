"""Who makes another command of one: what stands behind the last command before the hardware."""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain, filterfalse

from rtron.findings.inventory.command_topics import CommandTopics
from rtron.findings.inventory.doors import operators
from rtron.findings.inventory.things import COMMAND_NAMES, is_order, thing_of
from rtron.vocabulary import ActionRole, Endpoint, Trust, WiringFactKind, normalise_type
from rtron.vocabulary.inventory import SIGNALS, Command, Means

_MOST_HOPS = 6


@dataclass(frozen=True)
class Forwarding:
    """Tells how commands go from node to node."""

    topics: CommandTopics
    _walks: dict[str, frozenset[str]] = field(default_factory=dict, init=False, compare=False)

    def behind(self, commands: Iterable[Command]) -> Iterator[tuple[str, Command]]:
        """Yield each topic behind commands that leads to them, with the node that forwards it."""
        commands = tuple(commands)
        seen = {command.name for command in commands}
        nodes = dict.fromkeys(node for command in commands for node in command.senders)
        pending, visited = [(node, 1) for node in nodes], set(nodes)
        while pending:
            node, hops = pending.pop(0)
            ranks = self.topics.ranks.get(node, {})
            for topic in self._inputs(node, seen):
                if topic not in seen:
                    seen.add(topic)
                    found = self.topics.command(topic, hops)
                    yield node, replace(found, priority=ranks.get(topic, ""))
                    further = [n for n in found.senders if n not in visited and hops < _MOST_HOPS]
                    visited.update(further)
                    pending += [(each, hops + 1) for each in further]

    def _inputs(self, node: str, led: Collection[str]) -> tuple[str, ...]:
        """Return what a node without hardware is commanded by, or made to send what is led."""
        if self.topics.roles.drives(node):
            return ()
        inputs = filterfalse(self.is_feedback, self.topics.inputs.get(node, ()))
        return tuple(dict.fromkeys((*inputs, *self.topics.flows.leading(node, led))))

    def goals(self, actions: Iterable[Command]) -> Iterator[Command]:
        """Yield the topics from which the servers of actions take goals, too."""
        for node in dict.fromkeys(node for each in actions for node in each.receivers):
            for topic in () if self.topics.roles.drives(node) else self.topics.inputs.get(node, ()):
                if not self.is_feedback(topic):
                    yield self.topics.command(topic, 1)

    def buttons(self, requests: Iterable[Command]) -> Iterator[Command]:
        """Yield the signals, texts and joysticks that tell those who call services and actions.

        So does what makes them call, and stands behind all else.
        """
        requests = tuple(requests)
        names = {each.name for each in requests}
        for node in dict.fromkeys(node for each in requests for node in each.senders):
            leading = {*self.topics.flows.leading(node, names)}
            for each in map(self.topics.command, self._inputs(node, names)):
                is_pressed = each.type in SIGNALS or self.topics.is_by_hand(each.type)
                if is_pressed or is_order(each.name, each.type):
                    yield replace(each, hops=1)
                elif each.name in leading:
                    yield replace(each, hops=_MOST_HOPS)

    def unprompted(self, commands: Iterable[Command]) -> tuple[str, ...]:
        """Return the app's own nodes that send commands, and that nothing reaches which tells them.

        What they measure may decide when they begin.
        """
        commands = tuple(commands)
        led = {command.name for command in commands}
        senders = dict.fromkeys(node for each in commands for node in each.senders)
        return tuple(node for node in senders if self._is_unprompted(node, led))

    def _is_unprompted(self, node: str, led: Collection[str]) -> bool:
        app, has_input = self.topics.app, bool(self.topics.inputs.get(node))
        is_own = node in app.nodes and app.nodes[node].trust is Trust.OWN
        if has_input or not is_own or node in self._reached or node in app.unread_nodes:
            return False
        return not (any(self.topics.flows.leading(node, led)) or operators(app, {node}))

    @cached_property
    def _reached(self) -> frozenset[str]:
        """The nodes that requests, hardware or a network may tell something."""
        graph = self.topics.app.graph
        links = (WiringFactKind.DEVICE, WiringFactKind.SOCKET)
        found = {each.node for each in graph.services if not each.implicit}
        found |= {each.node for each in graph.actions if each.role is ActionRole.SERVER}
        return frozenset(found.union(f.subject for f in graph.wiring if f.kind in links))

    def decides(self, node: str) -> bool:
        """Return whether a node decides between commands: an arbiter, or one that takes several."""
        return node in self.topics.ranks or len(self.topics.inputs.get(node, ())) > 1

    def is_feedback(self, topic: str) -> bool:
        """Return whether those alone send a topic that drive and obey something else.

        What another controller hears is none: controllers command each other.
        """
        senders = self.topics.app.publishers(topic)
        chained = filter(self.topics.roles.is_controller, self.topics.app.readers(topic))
        return (
            bool(senders)
            and all(self._is_reporting(node, topic) for node in senders)
            and not any(reader not in senders for reader in chained)
        )

    def _is_reporting(self, node: str, topic: str) -> bool:
        """Return whether a driver obeys something, so that what it sends tells how it moves."""
        roles, inputs = self.topics.roles, self.topics.inputs.get(node, ())
        serves = node in self._servers and not self.topics.app.is_motion(topic)
        is_obeying = bool(set(inputs) - {topic}) or serves
        return roles.is_controller(node) or (roles.drives(node) and is_obeying)

    @cached_property
    def _servers(self) -> frozenset[str]:
        """The nodes that offer what moves something."""
        services = self.topics.app.graph.services
        return frozenset(s.node for s in services if thing_of(s.name, s.type, Means.SERVICE))

    def forwards(self, node: str, command: Command, *, to_unread: bool = True) -> bool:
        """Return whether a node makes another command of one, not only tells how it moves.

        What it sends goes further, and not back to who commands it; with `to_unread` it may go to
        who is not in the app.
        """
        if self.topics.roles.drives(node):
            return False
        behind = self._behind_nodes.get(node, Counter())
        obeying = self._obedient.get(command.name, frozenset())
        is_sender = node in command.senders
        others = behind.keys() - self._upstream(command)
        unread = self._unread_outputs.get(node, ()) if to_unread else ()
        return any(behind[each] > (is_sender and each in obeying) for each in others) or any(
            self._is_another(end, command) for end in unread
        )

    def _is_another(self, end: Endpoint, command: Command) -> bool:
        """Return whether what nobody here obeys is a command made of one.

        Its type or name says so, or that an arbiter sends it, or that it is made of commands, as
        what firmware gets.
        """
        if end.topic == command.name:
            return False
        is_same = normalise_type(end.type) == command.type
        is_named = COMMAND_NAMES.search("/".join(end.topic.split("/")[-2:])) is not None
        is_made = end.topic in self.topics.derived.keys() | self.topics.unheard.to_firmware
        is_made |= end.node in self.topics.ranks
        return is_same or is_named or is_made

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
        publishers = self.topics.app.graph.publishers
        return list(chain.from_iterable(map(publishers, sorted(self._leading_topics))))

    @cached_property
    def _obedient(self) -> dict[str, frozenset[str]]:
        """Who may obey each topic."""
        obeys, readers = self.topics.roles.obeys, self.topics.app.readers
        topics = self.topics.app.explicit_topics
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
        """Who sends what each node makes its commands of; drivers only tell how they move."""
        senders, is_feedback = self.topics.app.publishers, self.is_feedback
        return {
            node: frozenset(chain.from_iterable(map(senders, filterfalse(is_feedback, topics))))
            for node, topics in self.topics.inputs.items()
        }

    @cached_property
    def _leading_topics(self) -> frozenset[str]:
        """The command topics, and those that nodes make them of."""
        found, pending = set(self.topics.named_topics), list(self.topics.named_topics)
        while pending:
            for node in self.topics.app.publishers(pending.pop()):
                further = set(self.topics.inputs.get(node, ())) - found
                found |= further
                pending += further
        return frozenset(found)

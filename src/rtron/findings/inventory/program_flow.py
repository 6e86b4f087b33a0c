"""What each node does with what it gets, as far as its source was followed."""

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.vocabulary import (
    DESCRIPTORS,
    LIBRARY,
    UNKNOWN_OUTPUT,
    Direction,
    Evidence,
    WiringFact,
    WiringFactKind,
)

_NO_DEVICE = frozenset({"TCP link"})
"""What a source may connect to that need not be hardware."""


@dataclass(frozen=True)
class Way:
    """What an input of a node leads to: topics, services and actions; a device or a `library`."""

    led: frozenset[str] = frozenset()
    device: str = ""
    library: str = ""

    def __or__(self, other: "Way") -> "Way":
        device, library = self.device or other.device, self.library or other.library
        return Way(self.led | other.led, device, library)

    @property
    def is_used(self) -> bool:
        """Whether it leads to anything, or may."""
        return bool(self.led or self.device or self.library)

    @property
    def is_lost(self) -> bool:
        """Whether it ends in a library that is not read: what comes of it there is not seen."""
        return bool(self.library) and not (self.led or self.device)

    @property
    def is_unknown(self) -> bool:
        """Whether it may lead to something that is not seen, and to nothing that is."""
        return self.library == UNKNOWN_OUTPUT and not (self.led or self.device)


@dataclass(frozen=True)
class ProgramFlow:
    """Tells the ways through each node from its inputs to what it sends and writes."""

    app: AppFacts

    def way(self, node: str, topic: str) -> Way | None:
        """Return what messages of a topic lead to in a node; None where its source was not read."""
        return self.ways.get(node, {}).get(topic)

    def request(self, node: str, name: str) -> Way | None:
        """Return what a service or an action of a node leads to; None where that is not known."""
        return self._requests.get((node, name))

    def devices(self, node: str) -> tuple[WiringFact, ...]:
        """Return what the source of a node opens."""
        return tuple(self._devices[node])

    def moves_by_itself(self, node: str) -> WiringFact | None:
        """Return that a node writes to a device though nothing that it gets tells it to."""
        facts = (each for each in self._facts[WiringFactKind.SELF_MOTION] if each.subject == node)
        return next((each for each in facts if self._way(node, each).device), None)

    @cached_property
    def _facts(self) -> defaultdict[WiringFactKind, list[WiringFact]]:
        found = defaultdict[WiringFactKind, list[WiringFact]](list)
        for fact in self.app.graph.wiring:
            found[fact.kind].append(fact)
        return found

    @cached_property
    def _devices(self) -> defaultdict[str, list[WiringFact]]:
        found = defaultdict[str, list[WiringFact]](list)
        for fact in self._facts[WiringFactKind.DEVICE]:
            found[fact.subject].append(fact)
        return found

    @cached_property
    def ways(self) -> dict[str, dict[str, Way]]:
        """The ways from each topic that a node subscribes, by node."""
        found = defaultdict[str, dict[str, Way]](dict)
        for fact in self._facts[WiringFactKind.MESSAGE_FLOW]:
            for node, topic in chain.from_iterable(self._inputs[at] for at in fact.evidence[:1]):
                way = self._way(node, fact)
                if way.is_used or not fact.evidence[1:]:
                    found[node][topic] = found[node].get(topic, Way()) | way
        return found

    @cached_property
    def _requests(self) -> dict[tuple[str, str], Way]:
        """The ways from each service and action."""
        servers = defaultdict[str, set[str]](set)
        for service in self.app.graph.services:
            servers[service.name].add(service.node)
        for action in self.app.graph.actions:
            servers[action.name].add(action.node)
        found = dict[tuple[str, str], Way]()
        for fact in filter(lambda each: each.others, self._facts[WiringFactKind.REQUEST_FLOW]):
            name, *others = fact.others
            nodes = servers[name] & {fact.subject} or servers[name]  # a process, not its node
            found.update(((n, name), self._way(n, fact, tuple(others))) for n in nodes)
        return found

    def _way(self, node: str, fact: WiringFact, others: tuple[str, ...] | None = None) -> Way:
        """Return what a fact says of a node; what a source opens tells what a library writes to."""
        sent = chain.from_iterable(self._outputs[node, at] for at in fact.evidence[1:])
        led = frozenset(sent).union(fact.others if others is None else others)
        if fact.value in DESCRIPTORS:
            opened = (f.value for f in self._devices[node] if f.value not in _NO_DEVICE)
            return Way(led, device=next(opened, ""))
        is_library = fact.value == UNKNOWN_OUTPUT or fact.value.startswith(LIBRARY)
        return Way(led, "", fact.value) if is_library else Way(led, fact.value)

    @cached_property
    def _inputs(self) -> defaultdict[Evidence, list[tuple[str, str]]]:
        """The nodes and topics that are subscribed at each place."""
        found = defaultdict[Evidence, list[tuple[str, str]]](list)
        for end in self.app.graph.endpoints:
            for at in end.evidence if end.direction is Direction.SUBSCRIBE else ():
                found[at].append((end.node, end.topic))
        return found

    @cached_property
    def _outputs(self) -> defaultdict[tuple[str, Evidence], set[str]]:
        """What each node sends by what is made at a place."""
        found = defaultdict[tuple[str, Evidence], set[str]](set)
        for end in self.app.graph.endpoints:
            for at in end.evidence if end.direction is Direction.PUBLISH else ():
                found[end.node, at].add(end.topic)
        return found

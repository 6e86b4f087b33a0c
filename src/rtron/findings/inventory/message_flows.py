"""What the messages that a node gets lead to, as its source tells."""

import re
from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.things import ORDERS, may_be_command
from rtron.vocabulary import Direction, Evidence, WiringFactKind
from rtron.vocabulary.names import snake_case

_ANSWERS = re.compile(r"state|status|alive|complete|done|result|feedback|ack(?:_|$)|report|actual")
"""Words in the names of what a node answers that obeys commands."""


@dataclass(frozen=True)
class MessageFlows:
    """Tells by which topics a node is made to send something, and which of them it does not use."""

    app: AppFacts

    def is_unused(self, node: str, topic: str) -> bool:
        """Return whether a node does nothing with what it gets on a topic."""
        return self._flows.get(node, {}).get(topic) == frozenset()

    def led(self, node: str, topic: str) -> frozenset[str]:
        """Return what a node sends or calls because of a topic."""
        return self._flows.get(node, {}).get(topic, frozenset())

    def leading(self, node: str, names: Collection[str]) -> Iterator[str]:
        """Yield what makes a node send topics or call services, and is not only measured.

        What those answer that obey these commands is behind no command.
        """
        for topic, led in self._flows.get(node, {}).items():
            led_on = led.intersection(names)
            if led_on and self._may_be_order(topic):
                obeying = {reader for each in led_on for reader in self.app.readers(each)}
                is_answer = _ANSWERS.search(snake_case(topic.rpartition("/")[2]))
                if not (is_answer and obeying.intersection(self.app.publishers(topic))):
                    yield topic

    def _may_be_order(self, topic: str) -> bool:
        """Return whether a topic is no reading, nor sent by nobody and no text or signal."""
        type = self.app.facts.topic(topic).type
        is_sent = bool(self.app.publishers(topic)) or type in ORDERS
        return is_sent and may_be_command(topic, type)

    @cached_property
    def _flows(self) -> dict[str, dict[str, frozenset[str]]]:
        """What each topic leads to, by node; nothing where it is not used."""
        found = defaultdict[str, dict[str, frozenset[str]]](dict)
        inputs = self._inputs
        for fact in self.app.graph.wiring:
            if fact.kind is WiringFactKind.MESSAGE_FLOW:
                places = fact.evidence[1:]
                for node, topic in chain.from_iterable(inputs[at] for at in fact.evidence[:1]):
                    led = {name for at in places for name in self._outputs.get((node, at), ())}
                    led.update(fact.others)
                    if led or not (places or fact.value):
                        found[node][topic] = found[node].get(topic, frozenset()) | led
        return found

    @cached_property
    def outputs(self) -> dict[tuple[str, str], str]:
        """What the messages of nodes' topics are given to: a `device`, or another `library`."""
        flows = (f for f in self.app.graph.wiring if f.kind is WiringFactKind.MESSAGE_FLOW)
        places = ((at, fact.value) for fact in flows if fact.value for at in fact.evidence[:1])
        return {side: value for at, value in places for side in self._inputs[at]}

    @cached_property
    def _inputs(self) -> dict[Evidence, list[tuple[str, str]]]:
        """The nodes and topics that are subscribed at each place."""
        found = defaultdict[Evidence, list[tuple[str, str]]](list)
        for end in self.app.graph.endpoints:
            for at in end.evidence if end.direction is Direction.SUBSCRIBE else ():
                found[at].append((end.node, end.topic))
        return found

    @cached_property
    def _outputs(self) -> dict[tuple[str, Evidence], set[str]]:
        """What each node sends by what is made at a place."""
        found = defaultdict[tuple[str, Evidence], set[str]](set)
        for end in self.app.graph.endpoints:
            for at in end.evidence if end.direction is Direction.PUBLISH else ():
                found[end.node, at].add(end.topic)
        return found

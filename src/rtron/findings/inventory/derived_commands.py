"""The commands that nodes make of others, whatever these are called: wheel states, pulses, frames.

A node obeys a known command and does not stand next to hardware: then what it sends to a driver is
a command, too, though neither name nor type says so. Where nobody in the app hears what it sends,
arrays of numbers with a name that moves something leave the app, for firmware; a single number may
be a reading, unless the node is called like a driver.

States of joints that a node without hardware sends to one with hardware are what the joints get.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.node_roles import NodeRoles
from rtron.findings.inventory.things import may_be_derived, part_of_states, thing_of
from rtron.vocabulary import Endpoint, normalise_type
from rtron.vocabulary.inventory import NO_MOTION, Means, Thing

_NUMBER = re.compile(r"std_msgs/(?:U?Int|Float)\d+")
_NUMBERS = re.compile(rf"{_NUMBER.pattern}MultiArray|geometry_msgs/Wrench(?:Stamped)?")
REPORTS = re.compile(
    r"error|debug|state|status|feedback|actual|measured|current|target|desired|reference"
)
"""Words in the names of what a controller tells of its work."""


_DEMANDED = re.compile(
    r"^(?!.*(?:state|error))(?:.*_)?(?:target|goal|cmd|command|desired|setpoint)"
)


@dataclass(frozen=True)
class DerivedCommands:
    """Finds the commands that are made of others."""

    app: AppFacts
    roles: NodeRoles

    def find(self, known: Mapping[str, Thing]) -> dict[str, Thing]:
        """Return the topics that nodes make of `known` commands, each with what it moves.

        What is made of several moves the first of `Thing`. Known commands that do not tell what
        they move are found, too: they move what they are made of.
        """
        found = dict(self._demanded_states)
        order = list(Thing)
        pending = [(t, x) for t, x in {**known, **found}.items() if x not in NO_MOTION]
        pending.sort(key=lambda each: order.index(each[1]), reverse=True)
        clear = {topic for topic, thing in known.items() if thing is not Thing.DEVICE}
        while pending:
            topic, thing = pending.pop()
            done = known.keys() if thing is Thing.DEVICE else clear
            for end in self._made_of(topic, done | found.keys()):
                found[end.topic] = self._thing(end, thing)
                pending.append((end.topic, found[end.topic]))
        return found

    def receivers(self, topic: str) -> tuple[str, ...]:
        """Return who obeys a topic: of states, the nodes with hardware alone."""
        obeys = self.roles.moves_hardware if topic in self._demanded_states else self.roles.obeys
        return tuple(filter(obeys, self.app.readers(topic)))

    @cached_property
    def _demanded_states(self) -> dict[str, Thing]:
        """The states that nodes with hardware hear, sent by none that measures them."""
        inputs = chain.from_iterable(map(self.app.graph.subscribed_by, self.roles.with_device))
        found = {e.topic: part_of_states(e.topic, e.type) for e in filter(_is_free, inputs)}
        return {topic: part for topic, part in found.items() if part and self._is_demand(topic)}

    def _is_demand(self, topic: str) -> bool:
        senders = self.app.publishers(topic)
        is_obeyed = any(map(self.roles.moves_hardware, self.app.readers(topic)))
        return is_obeyed and not any(map(self.roles.drives, senders))

    def _made_of(self, topic: str, known: Iterable[str]) -> Iterator[Endpoint]:
        """Yield the endpoints that send what is made of a topic and was not known before."""
        senders = self.app.publishers(topic)
        for node in self.app.readers(topic):
            if self.roles.obeys(node) and not self.roles.drives(node) and node not in senders:
                outputs = [end for end in self.app.graph.published_by(node) if _is_free(end)]
                driving = [end for end in outputs if self._is_driven(end, {node, *senders})]
                is_last = not driving and not any(end.topic in known for end in outputs)
                yield from (end for end in driving if end.topic not in known)
                leaving = list(filter(self._leaves, outputs)) if is_last else []
                numbers = [end for end in leaving if not _is_wrench(end)]
                yield from numbers or leaving

    def _is_driven(self, end: Endpoint, others: set[str]) -> bool:
        readers = set(self.app.readers(end.topic)) - others
        return may_be_derived(end.topic, end.type) and any(
            map(self.roles.is_called_driver, readers)
        )

    def _leaves(self, end: Endpoint) -> bool:
        """Return whether nobody here hears numbers whose name moves something.

        So may joints be that a name demands.
        """
        if self.app.readers(end.topic):
            return False
        type, last = normalise_type(end.type), end.topic.rpartition("/")[2]
        if type == "sensor_msgs/JointState" and _DEMANDED.search(last):
            return True
        is_number = _NUMBER.fullmatch(type) and self.roles.is_called_driver(end.node)
        may_leave = not REPORTS.search(last) and bool(_NUMBERS.fullmatch(type) or is_number)
        return may_leave and self._named(end) not in {None, Thing.DEVICE, *NO_MOTION}

    def _thing(self, end: Endpoint, source: Thing) -> Thing:
        """Return what a command moves: what it says, else what the command moves it is made of."""
        named = self._named(end)
        return source if named in {None, Thing.DEVICE, *NO_MOTION} else named or source

    def _named(self, end: Endpoint) -> Thing | None:
        return thing_of(end.topic, end.type, Means.TOPIC)


def _is_wrench(end: Endpoint) -> bool:
    """Return whether a message is a wrench: beside raw numbers it only shows them."""
    return normalise_type(end.type).startswith("geometry_msgs/Wrench")


def _is_free(end: Endpoint) -> bool:
    return not end.implicit and "{" not in end.topic

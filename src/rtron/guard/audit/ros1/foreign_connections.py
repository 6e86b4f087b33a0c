"""Which connections of a guarded node the plan does not name, and what to call them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from rtron.guard.audit.ros1.bus_info import Link
from rtron.guard.audit.ros1.expected_graph import is_open
from rtron.guard.audit.ros1.node_addresses import Addresses
from rtron.guard.core.printable import shown
from rtron.vocabulary import Alarm, AlarmKind, PlannedTopic


@dataclass(frozen=True, slots=True, kw_only=True)
class Stranger:
    """A connection through which a guarded node hears somebody whom the plan does not name there.

    `guarded` is the public name of the stream that it goes past.
    """

    node: str
    link: Link
    guarded: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """What could be found out about a stranger.

    `name`: whom the master lists at the address. `refused`: nothing listens there any more.
    `answered`: the master has said what it knows.
    """

    name: str = ""
    refused: bool = False
    answered: bool = False


def strangers_of(
    node: str, links: Iterable[Link], heard: Mapping[str, PlannedTopic], known: Addresses
) -> frozenset[Stranger]:
    """Return the connections of a node that should not be.

    Their ports are left out: rospy shows a connection before it stands and has a port.
    """
    return frozenset(
        Stranger(node=node, link=replace(link, port=None), guarded=heard[link.topic].guarded)
        for link in links
        if link.topic in heard and not _planned(link, heard[link.topic], known)
    )


def planned_sources(topic: PlannedTopic, links: Iterable[Link], known: Addresses) -> frozenset[str]:
    """Return the addresses from which a node rightly hears a topic."""
    return frozenset(
        link.source for link in links if link.topic == topic.topic and _planned(link, topic, known)
    )


def alarm_of(stranger: Stranger, identity: Identity, own: frozenset[str]) -> Alarm:
    """Return what to tell about a stranger; what strangers call themselves is cut short."""
    peer = shown(identity.name or stranger.link.source)
    kind, who = _kind(stranger, identity, own)
    hears = f"{stranger.node} hears {stranger.link.topic} from {who}, past the guard"
    return Alarm(kind=kind, reason=hears, topic=stranger.link.topic, node=stranger.node, peer=peer)


def _kind(stranger: Stranger, identity: Identity, own: frozenset[str]) -> tuple[AlarmKind, str]:
    source, name = shown(stranger.link.source), shown(identity.name)
    if identity.name in own:
        return AlarmKind.IMPOSTOR, f"{source}, which has taken the name {name}"
    if identity.name:
        return AlarmKind.FOREIGN_PUBLISHER, f"{name} at {source}"
    return AlarmKind.GHOST, f"{source or 'nowhere'}, where the master lists no publisher of it"


def _planned(link: Link, topic: PlannedTopic, known: Addresses) -> bool:
    if is_open(topic):
        return True
    node = known.node_of(link)
    return bool(node) and topic.may_publish(node)

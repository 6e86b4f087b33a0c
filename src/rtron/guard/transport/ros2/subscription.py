"""A topic that one of our nodes subscribes: every publisher in the graph, told by its GID.

Each publisher is offered once to `connect`; its messages are read by a reader that asks for exactly
what it offers, so that publishers of different QoS are all heard, and each only once. Messages
whose publisher the graph does not name yet wait a moment for its name.
"""

from __future__ import annotations

import logging
from collections import deque
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from rtron.errors import SourceError, WireError
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.guard.transport.ros2.data_reader import Reader
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.ros2.cdr_validator import whole
from rtron.vocabulary import SECOND, Durability, QoS, Reliability, names_node, normalise_type
from rtron.wire.ros2.endpoints import PARTICIPANT
from rtron.wire.ros2.interfaces import Interface, interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.transport.common.protocol import Connect, Lost, Momentary, Receive
    from rtron.guard.transport.ros2.context import Surroundings
    from rtron.wire.ros2.endpoints import Ros2Endpoint

log = logging.getLogger(__name__)

_AWAIT_NAME = 5 * SECOND
_REFUSED_FOR = 5 * SECOND
_FRESH = SECOND // 2
_MOST_UNNAMED = 256
_MOST_OF_ONE = 32
_MOST_READERS = 8
_MOST_NAMES = 64
_MOST_TYPES = 512
_MOST_WAITING = 1 << 24
"""Messages that wait for a name may have so many bytes together."""

_Kind = tuple[type, Reliability, Durability]


@dataclass(frozen=True, slots=True)
class Terms:
    """Whom to hear, and how; see `Transport.subscribe`."""

    connect: Connect
    lost: Lost
    momentary: Momentary
    publishers: tuple[str, ...]


@dataclass(slots=True)
class _Sender:
    """A publisher that was offered, and what takes its messages, None if it was refused."""

    peer: Peer
    receive: Receive | None
    at: int = 0
    check: Callable[[bytes], object] | None = None
    reader: Reader | None = None

    def is_as(self, peer: Peer, now: int) -> bool:
        """Tell whether nothing has changed; who was refused is offered again after a while."""
        refused_long_ago = self.receive is None and now - self.at >= _REFUSED_FOR
        return self.peer == peer and not refused_long_ago


class Subscription:
    """Hands each publisher's messages to what `connect` gave for it, and tells who has left."""

    def __init__(
        self, node: Node, topic: str, type: str, terms: Terms, shared: Surroundings
    ) -> None:
        """Hear publishers of one type, "" for any."""
        self.topic = topic
        self._type = normalise_type(type)
        self._node = node
        self._terms = terms
        self._shared = shared
        self._senders: dict[bytes, _Sender] = {}
        self._readers: dict[_Kind, Reader] = {}
        self._unnamed: deque[tuple[int, Reader, bytes, bytes]] = deque(maxlen=_MOST_UNNAMED)
        self._seen: dict[bytes, int] = {}
        self._seldom = Seldom()
        shared.graph.watch(topic)
        shared.graph.changed.append(self.update)

    def update(self) -> None:
        """Take what the graph says: who has come, who has left, whose name is no more its own."""
        listed = {each.gid: each for each in self._shared.graph.ends(self.topic).publishers}
        for gid in self._senders.keys() - listed.keys():
            self._leave(gid)
        self._seen = {gid: at for gid, at in self._seen.items() if gid in listed}
        for each in listed.values():
            self._meet(each)
        self._hear_unnamed()

    def close(self) -> None:
        """Hear nobody any more."""
        self._shared.graph.changed.remove(self.update)
        for reader in self._readers.values():
            reader.close()
        self._readers.clear()
        self._senders.clear()

    def _meet(self, endpoint: Ros2Endpoint) -> None:
        """Offer a publisher that is new, was refused, or is not what it was."""
        now = self._shared.loop.now()
        since = self._seen.setdefault(endpoint.gid, now)
        if not endpoint.node and now - since < _AWAIT_NAME:
            return
        peer = self._peer(endpoint)
        sender = self._senders.get(endpoint.gid)
        if sender and sender.is_as(peer, now):
            return
        if sender:
            self._leave(endpoint.gid)
        self._senders[endpoint.gid] = self._offered(endpoint, peer)

    def _peer(self, endpoint: Ros2Endpoint) -> Peer:
        node = self._name(endpoint)
        return Peer(
            node=node,
            info=_info_of(endpoint),
            latching=endpoint.qos.durability is Durability.TRANSIENT_LOCAL,
            verified=self._shared.owners.has(node, endpoint.participant),
            qos=endpoint.qos,
        )

    def _name(self, endpoint: Ros2Endpoint) -> str:
        """Return a publisher's node; one of those that are awaited keeps a name that is its own.

        No endpoint changes its node, and anybody can tell the domain another name for it.
        """
        known = self._senders.get(endpoint.gid)
        if known and known.peer.verified and self._awaits(known.peer.node):
            return known.peer.node
        return endpoint.node

    def _awaits(self, node: str) -> bool:
        return any(names_node(each, node) for each in self._terms.publishers)

    def _offered(self, endpoint: Ros2Endpoint, peer: Peer) -> _Sender:
        now = self._shared.loop.now()
        found, why = self._readable(endpoint)
        if found is None:
            self._complain(peer, why)
            return _Sender(peer, None, now)
        receive = self._terms.connect(peer)
        if receive is None:
            return _Sender(peer, None, now)
        reader = self._reader(found, endpoint.qos, peer)
        return _Sender(peer, receive, now, _check_of(found), reader)

    def _readable(self, endpoint: Ros2Endpoint) -> tuple[Interface | None, str]:
        """Return how a publisher's messages are read, or why they cannot be."""
        if self._type not in ("", normalise_type(endpoint.type)):
            return None, f"is not heard: it publishes {endpoint.type}, not {self._type}"
        found = installed(endpoint.type)
        if isinstance(found, SourceError):
            return None, f"cannot be heard: {found}; {found.help}"
        if _differs(endpoint, found):
            return None, f"is not heard: its {endpoint.type} is another version than the one here"
        return found, ""

    def _reader(self, found: Interface, qos: QoS, peer: Peer) -> Reader | None:
        momentary = self._terms.momentary(peer)
        kind = (found.cls, qos.reliability, qos.durability)
        if kind not in self._readers:
            if len(self._readers) == _MOST_READERS:
                self._complain(peer, "is not heard: too many types and QoS on one topic")
                return None
            if self._readers:
                told = "%s: its publishers differ in QoS or type; %s is read apart, as %s, %s"
                log.warning(told, self.topic, peer.node, qos.reliability, qos.durability)
            self._readers[kind] = Reader(
                self._node,
                found.cls,
                self.topic,
                qos,
                self._shared,
                self._heard,
                momentary=momentary,
            )
        return self._readers[kind]

    def _heard(self, reader: Reader, gid: bytes, message: bytes) -> None:
        sender = self._senders.get(gid)
        if sender is None:
            self._heard_stranger(reader, gid, message)
        elif sender.reader is reader and sender.receive and sender.check:
            try:
                sender.check(message)
            except WireError as error:
                self._complain(sender.peer, f"a message is dropped: {error}")
            else:
                sender.receive(message)

    def _heard_stranger(self, reader: Reader, gid: bytes, message: bytes) -> None:
        """Let a message wait until the graph names its publisher; our own words are nobody's."""
        if self._shared.graph.is_own(gid):
            return
        own = sum(each[2][:PARTICIPANT] == gid[:PARTICIPANT] for each in self._unnamed)
        waiting = sum(len(each[-1]) for each in self._unnamed)
        if own < _MOST_OF_ONE and waiting + len(message) <= _MOST_WAITING:
            self._unnamed.append((self._shared.loop.now(), reader, gid, message))
        self._shared.graph.look(self.topic)

    def _hear_unnamed(self) -> None:
        """Hear what has waited for a name; of those who are not there, drop it in time."""
        now, waiting = self._shared.loop.now(), list(self._unnamed)
        self._unnamed.clear()
        for since, reader, gid, message in waiting:
            if gid in self._senders:
                self._hear_late(reader, gid, message, now - since)
            elif now - since < 2 * _AWAIT_NAME:
                self._unnamed.append((since, reader, gid, message))
            elif self._seldom.may_say("unnamed", now):
                log.warning("%s: messages of nobody in the graph are dropped", self.topic)

    def _hear_late(self, reader: Reader, gid: bytes, message: bytes, waited: int) -> None:
        """Hear what has waited for a name, unless it was meant for the moment and is old."""
        if waited < _FRESH or self._senders[gid].peer.latching:
            self._heard(reader, gid, message)

    def _leave(self, gid: bytes) -> None:
        sender = self._senders.pop(gid)
        if sender.receive is not None:
            self._terms.lost(sender.peer)

    def _complain(self, peer: Peer, why: str) -> None:
        """Tell what is not heard of a publisher, at most once a second of each."""
        if self._seldom.may_say(hash(peer.node) % _MOST_NAMES, self._shared.loop.now()):
            self._shared.complain(self.topic, peer.node, why)


def _info_of(endpoint: Ros2Endpoint) -> TypeInfo:
    """Return the publisher's type; one of another hash than ours equals nothing that is known."""
    found = installed(endpoint.type)
    if isinstance(found, SourceError):
        return TypeInfo(endpoint.type, endpoint.type_hash)
    if _differs(endpoint, found):
        return TypeInfo(found.name, endpoint.type_hash)
    return TypeInfo(found.name, found.md5sum, found.definition)


def _differs(endpoint: Ros2Endpoint, found: Interface) -> bool:
    told = endpoint.type_hash
    return bool(told) and found.type_hash not in ("", told)


@lru_cache(_MOST_TYPES)
def installed(type: str) -> Interface | SourceError:
    """Return a type that is installed here, or why it is not; asked once for each."""
    try:
        return interface(type)
    except SourceError as error:
        return error


def _check_of(found: Interface) -> Callable[[bytes], object]:
    return whole(parse_definition(found.name, found.definition))

"""A topic that one of our nodes subscribes to: every publisher in the graph, known by its GID.

Each publisher is offered once to `on_connect`. A reader that requests exactly the publisher's QoS
reads its messages, so that publishers of different QoS all get through, and each only once.
Messages whose publisher has no name in the graph yet wait a moment for it.
"""

from __future__ import annotations

import logging
from collections import deque
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from rtron.errors import SourceError, WireError
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.guard.transport.ros2.data_reader import DataListener, DataReader
from rtron.guard.transport.ros2.delivery import SequenceGaps
from rtron.guard.transport.ros2.qos import requested_profile
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.ros2.cdr_validator import cdr_validator
from rtron.vocabulary import SECOND, Durability, QoS, Reliability, matches_node, normalise_type
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE
from rtron.wire.ros2.interfaces import Interface, find_interface

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from rtron.guard.transport.common.protocol import (
        ConnectHandler,
        InputOptions,
        MessageHandler,
    )
    from rtron.guard.transport.ros2.context import TransportContext
    from rtron.wire.ros2.endpoints import Ros2Endpoint

log = logging.getLogger(__name__)

_NAME_TIMEOUT = 5 * SECOND
_REFUSAL_PERIOD = 5 * SECOND
_FRESH = SECOND // 2
_MAX_UNRESOLVED = 256
_MAX_PER_PARTICIPANT = 32
_MAX_READERS = 8
_MAX_TYPES = 512
_MAX_WAITING_BYTES = 1 << 24
"""The most bytes of all messages that wait for a name."""

_Kind = tuple[type, Reliability, Durability]


@dataclass(slots=True)
class _PublisherState:
    """A publisher that was offered, and the handler of its messages, None if refused."""

    peer: Peer
    receive: MessageHandler | None
    refused_at: int = 0
    validate: Callable[[bytes], object] | None = None
    reader: DataReader | None = None

    def is_unchanged(self, peer: Peer, now: int) -> bool:
        """Return whether nothing has changed; a refused one is offered again after a while."""
        refused_long_ago = self.receive is None and now - self.refused_at >= _REFUSAL_PERIOD
        return self.peer == peer and not refused_long_ago


@dataclass(slots=True)
class _Unresolved:
    """A message that waits for its publisher's name, with its number and when it came."""

    reader: DataReader
    gid: bytes
    message: bytes
    number: int | None
    since: int = 0

    @property
    def participant(self) -> bytes:
        return self.gid[:PARTICIPANT_SIZE]


class Subscription(DataListener):
    """Passes each publisher's messages to its handler, and reports publishers that leave."""

    def __init__(
        self,
        node: Node,
        topic: str,
        type: str,
        on_connect: ConnectHandler,
        options: InputOptions,
        context: TransportContext,
    ) -> None:
        """Subscribe to publishers of one type, "" for any."""
        self.topic = topic
        self._type = normalise_type(type)
        self._node = node
        self._on_connect, self._options = on_connect, options
        self._context = context
        self._senders: dict[bytes, _PublisherState] = {}
        self._readers: dict[_Kind, DataReader] = {}
        self._unresolved: deque[_Unresolved] = deque(maxlen=_MAX_UNRESOLVED)
        self._gaps = SequenceGaps()
        self._first_seen: dict[bytes, int] = {}
        self._log_throttle = LogThrottle()
        context.graph.watch(topic)
        context.graph.listeners.append(self.update)

    def update(self) -> None:
        """Take the new graph: publishers that have come, left, or changed their name."""
        endpoints = {
            each.gid: each for each in self._context.graph.endpoints(self.topic).publishers
        }
        for gid in self._senders.keys() - endpoints.keys():
            self._remove_publisher(gid)
        self._first_seen = {gid: at for gid, at in self._first_seen.items() if gid in endpoints}
        for each in endpoints.values():
            self._offer_publisher(each)
        self._deliver_unresolved()

    def close(self) -> None:
        """Close all readers."""
        self._context.graph.listeners.remove(self.update)
        for reader in self._readers.values():
            reader.close()
        self._readers.clear()
        self._senders.clear()

    def is_of(self, node: str, topic: str) -> bool:
        """Return whether this is a topic of a node of ours."""
        return self.topic == topic and self._node.get_fully_qualified_name() == node

    def _offer_publisher(self, endpoint: Ros2Endpoint) -> None:
        """Offer a publisher that is new, was refused, or is not what it was."""
        now = self._context.loop.now()
        since = self._first_seen.setdefault(endpoint.gid, now)
        if not endpoint.node and now - since < _NAME_TIMEOUT:
            return
        peer = self._peer(endpoint)
        sender = self._senders.get(endpoint.gid)
        if sender and sender.is_unchanged(peer, now):
            return
        if sender:
            self._remove_publisher(endpoint.gid)
        self._senders[endpoint.gid] = self._connect_publisher(endpoint, peer)

    def _peer(self, endpoint: Ros2Endpoint) -> Peer:
        node = self._name(endpoint)
        return Peer(
            node=node,
            info=_type_info_of(endpoint),
            latching=endpoint.qos.durability is Durability.TRANSIENT_LOCAL,
            verified=self._context.owners.is_owner(node, endpoint.participant),
            qos=endpoint.qos,
        )

    def _name(self, endpoint: Ros2Endpoint) -> str:
        """Return a publisher's node; an expected publisher keeps a name that it owns.

        No endpoint changes its node, and anybody can announce another name for it.
        """
        known = self._senders.get(endpoint.gid)
        if known and known.peer.verified and self._is_expected(known.peer.node):
            return known.peer.node
        return endpoint.node

    def _is_expected(self, node: str) -> bool:
        return any(matches_node(each, node) for each in self._options.publishers)

    def _connect_publisher(self, endpoint: Ros2Endpoint, peer: Peer) -> _PublisherState:
        now = self._context.loop.now()
        interface_type, why = self._find_interface(endpoint)
        if interface_type is None:
            self._log_problem(peer, why)
            return _PublisherState(peer, None, now)
        receive = self._on_connect(peer)
        if receive is None:
            return _PublisherState(peer, None, now)
        reader = self._reader_for(interface_type, endpoint.qos, peer)
        validate = _accept if self._options.begin else _validator_of(interface_type)
        return _PublisherState(peer, receive, now, validate, reader)

    def _find_interface(self, endpoint: Ros2Endpoint) -> tuple[Interface | None, str]:
        """Return the interface of a publisher's messages, or why they cannot be read."""
        if self._type not in ("", normalise_type(endpoint.type)):
            return None, f"is ignored: it publishes {endpoint.type}, not {self._type}"
        interface_type = installed_type(endpoint.type)
        if isinstance(interface_type, SourceError):
            return None, f"is ignored: {interface_type}; {interface_type.help}"
        if _is_other_version(endpoint, interface_type):
            return None, f"is ignored: its {endpoint.type} is another version than the one here"
        return interface_type, ""

    def _reader_for(self, interface_type: Interface, qos: QoS, peer: Peer) -> DataReader | None:
        is_command = self._options.is_command(peer)
        if is_command and qos.durability is Durability.TRANSIENT_LOCAL:
            text = "%s: commands that %s sent before the guard listened are not taken"
            log.info(text, self.topic, peer.node)
            qos = replace(qos, durability=Durability.VOLATILE)
        kind = (interface_type.cls, qos.reliability, qos.durability)
        if kind not in self._readers:
            if len(self._readers) == _MAX_READERS:
                self._log_problem(peer, "is ignored: too many types and QoS on one topic")
                return None
            if self._readers:
                text = "%s: its publishers differ in QoS or type; %s has its own reader, %s, %s"
                log.warning(text, self.topic, peer.node, qos.reliability, qos.durability)
            keep_all = self._options.keep_all and not is_command
            self._readers[kind] = DataReader(
                self._node,
                interface_type.cls,
                self.topic,
                requested_profile(qos, self._options.queue_size, keep_all=keep_all),
                self._context,
                self,
                is_command=is_command,
            )
            self._readers[kind].begin = self._options.begin
        return self._readers[kind]

    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> bool:
        """Pass on a message of a publisher that was accepted, and return whether it was."""
        sender = self._senders.get(gid)
        if sender is None:
            self._queue_unresolved(_Unresolved(reader, gid, message, number))
        elif reader.is_changing and self._gaps.is_repeated(gid, number):
            return False
        elif sender.reader is reader and sender.receive and sender.validate:
            if missing := self._gaps.missing_before(gid, number):
                self._options.on_missed(sender.peer, missing)
            try:
                sender.validate(message)
            except WireError as error:
                self._log_problem(sender.peer, f"a message is dropped: {error}")
            else:
                sender.receive(message)
                return True
        return False

    def note_late(self, reader: DataReader, gid: bytes, number: int | None) -> None:
        """Count a late message as lost, with those that are missing before it."""
        sender = self._senders.get(gid)
        if reader.is_changing and self._gaps.is_repeated(gid, number):
            return
        if sender and sender.reader is reader and sender.receive:
            missing = self._gaps.missing_before(gid, number)
            self._options.on_missed(sender.peer, missing + 1)

    def note_replaced(self, count: int) -> None:
        """Count the messages that the first one of a publisher has replaced in its queue."""
        gid, number = self._gaps.replaced(count)
        sender = self._senders.get(gid) if gid else None
        if number and sender and sender.receive:
            self._options.on_missed(sender.peer, number)

    def _queue_unresolved(self, new: _Unresolved) -> None:
        """Let a message wait until the graph names its publisher; drop our own messages."""
        if self._context.graph.is_own(new.gid):
            return
        new.since = self._context.loop.now()
        self._gaps.see(new.gid, new.number)
        own_count = sum(each.participant == new.participant for each in self._unresolved)
        waiting = sum(len(each.message) for each in self._unresolved)
        if own_count < _MAX_PER_PARTICIPANT and waiting + len(new.message) <= _MAX_WAITING_BYTES:
            self._unresolved.append(new)
        self._context.graph.query_if_due(self.topic)

    def _deliver_unresolved(self) -> None:
        """Deliver messages whose publisher has a name now; drop those that have waited too long."""
        now, unresolved = self._context.loop.now(), list(self._unresolved)
        self._unresolved.clear()
        for each in unresolved:
            each.gid = self._context.sender_ids.gid(each.gid)
            if each.gid in self._senders:
                self._deliver_late(each, now - each.since)
            elif now - each.since < 2 * _NAME_TIMEOUT:
                self._unresolved.append(each)
            elif self._log_throttle.allows("unnamed", now):
                log.warning("%s: messages of an unknown publisher are dropped", self.topic)

    def _deliver_late(self, late: _Unresolved, waited: int) -> None:
        """Deliver a message that has waited, unless it is an old one that was not latched."""
        peer = self._senders[late.gid].peer
        if waited < _FRESH or (peer.latching and not self._options.is_command(peer)):
            self.take(late.reader, late.gid, late.message, late.number)

    def _remove_publisher(self, gid: bytes) -> None:
        sender = self._senders.pop(gid)
        self._gaps.forget(gid)
        if sender.receive is not None:
            self._options.on_lost(sender.peer)

    def _log_problem(self, peer: Peer, why: str) -> None:
        """Report an unreadable message or publisher, at most once a second for each."""
        if self._log_throttle.allows(peer.node, self._context.loop.now()):
            self._context.report_unreadable(self.topic, peer.node, why)


def _type_info_of(endpoint: Ros2Endpoint) -> TypeInfo:
    """Return the publisher's type; one with another hash than ours equals no known type."""
    interface_type = installed_type(endpoint.type)
    if isinstance(interface_type, SourceError):
        return TypeInfo(endpoint.type, endpoint.type_hash)
    if _is_other_version(endpoint, interface_type):
        return TypeInfo(interface_type.name, endpoint.type_hash)
    return TypeInfo(interface_type.name, interface_type.md5sum, interface_type.definition)


def _is_other_version(endpoint: Ros2Endpoint, interface_type: Interface) -> bool:
    type_hash = endpoint.type_hash
    return bool(type_hash) and interface_type.type_hash not in ("", type_hash)


@lru_cache(_MAX_TYPES)
def installed_type(type: str) -> Interface | SourceError:
    """Return a type that is installed here, or why it is not; looked up once."""
    try:
        return find_interface(type)
    except SourceError as error:
        return error


def _accept(_message: bytes) -> None:
    """Accept the beginning of a message: who reads it checks what it needs."""


def _validator_of(interface_type: Interface) -> Callable[[bytes], object]:
    return cdr_validator(parse_definition(interface_type.name, interface_type.definition))

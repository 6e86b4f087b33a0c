"""The ends of one stream on a transport: who is heard on them, and as which flow."""

import logging
from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial

from rtron.guard.core.handover_state import Will
from rtron.guard.core.latched_messages import Latched
from rtron.guard.core.message_types import codec_of, standard_info
from rtron.guard.core.observations import Senses
from rtron.guard.core.printable import shown
from rtron.guard.core.stream_outputs import Ends
from rtron.guard.derived import with_unapproved, written_for
from rtron.guard.transport.common.protocol import Connect, Peer, Receive, Transport, TypeInfo
from rtron.messages.common.velocity import VelocityCodec
from rtron.vocabulary import (
    PRIVATE_ROOT,
    UNAPPROVED,
    CoordinationKind,
    Flow,
    Mode,
    Stream,
    StreamKind,
    flow_topic,
    names_node,
)

log = logging.getLogger(__name__)

_LONGEST_NAME = 128
_MOST_STRANGERS = 32


class Connected(ABC):
    """Closed at both ends: an approved publisher speaks on its flow's private topic.

    A successor listens on the private output, and what arrives under the public name is
    `unapproved`.
    """

    def __init__(
        self, stream: Stream, transport: Transport, senses: Senses, will: Will, *, dry_run: bool
    ) -> None:
        self.stream = self._complete(stream)
        self.nodes = tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)
        self.strangers: dict[str, int] = {}
        self.dry_run = dry_run
        self._transport = transport
        self._ends = Ends(self.stream, self.nodes, transport)
        self._latched = Latched(stream.topic, will)
        self._md5sum = written_for(stream, senses)
        self._info: TypeInfo | None = None

    @abstractmethod
    def _receive(self, flow: str, message: bytes) -> object:
        """Take a message of a flow."""

    @abstractmethod
    def _done(self, message: bytes) -> None:
        """Take a message that tells that an action is done."""

    @abstractmethod
    def _learned(self, codec: VelocityCodec) -> None:
        """Take how the velocities in the stream's messages are laid out."""

    def report(
        self, learned: Callable[[TypeInfo], None], sent: Callable[[str, bytes], None]
    ) -> None:
        """Tell from now on which type was learned, and each message that goes out."""
        self._ends.report(learned, sent)

    def _complete(self, stream: Stream) -> Stream:
        """Return a stream as it is guarded."""
        return with_unapproved(stream)

    def _open_ends(self) -> None:
        if self.stream.mode is Mode.ENFORCE:
            self._ends.open()
            for flow in self.stream.flows:
                topic = flow_topic(self.stream.topic, flow.name)
                self._subscribe(topic, partial(self._connect_flow, flow), (flow.publisher,))
        self._subscribe(self.stream.topic, self._connect_public)
        self._open_done()

    def _open_done(self) -> None:
        if self.stream.done:
            self._hear_successors(self.stream.done, "", self._connect_done)

    def _hear_successors(self, topic: str, type: str, connect: Connect) -> None:
        awaited = self.stream.successors
        self._transport.subscribe(self.nodes[0], topic, type, connect, publishers=awaited)

    def _subscribe(self, topic: str, connect: Connect, publishers: tuple[str, ...] = ()) -> None:
        self._transport.subscribe(
            self.nodes[0],
            topic,
            self.stream.type,
            connect,
            momentary=self._is_momentary,
            publishers=publishers,
        )

    def _connect_flow(self, flow: Flow, peer: Peer) -> Receive | None:
        if not (peer.verified and names_node(flow.publisher, peer.node)):
            return self._stranger(peer, f"on the private topic of {flow.name}")
        if not self._learn(peer):
            return None
        self._ends.latch(flow.name, latching=peer.latching and self._keeps(peer))
        if peer.qos:
            self._ends.offer(flow.name, peer.qos)
        return self._taking(flow.name, peer)

    def _connect_public(self, peer: Peer) -> Receive | None:
        if self.stream.mode is Mode.OBSERVE:
            known = (f for f in self.stream.flows if names_node(f.publisher, peer.node))
            flow = next(known, None)
            if flow is not None:
                return self._taking(flow.name, peer) if self._learn(peer) else None
        return self._stranger(peer, "under the public name")

    def _connect_done(self, peer: Peer) -> Receive | None:
        said_by_successor = any(names_node(each, peer.node) for each in self.stream.successors)
        return self._done if peer.verified and said_by_successor else None

    def _stranger(self, peer: Peer, where: str) -> Receive | None:
        if not self.stream.block_unapproved and not self._learn(peer):
            return None
        name = shown(peer.node)[:_LONGEST_NAME]
        if name in self.strangers or len(self.strangers) < _MOST_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        log.warning("%s: unapproved publisher %s %s", self.stream.topic, name, where)
        if self.dry_run and not self._ends.knows(peer.info):
            return None
        return self._taking(UNAPPROVED, peer)

    def _taking(self, flow: str, peer: Peer) -> Receive:
        """Return what takes the messages of a publisher; what it has kept is done once.

        Of those who are blocked nothing is remembered: they are as many as they like.
        """
        take = partial(self._receive, flow)
        is_blocked = flow == UNAPPROVED and self.stream.block_unapproved
        once = self._goes_once(peer) and not is_blocked
        return self._latched.once(peer.node, take) if once else take

    def _goes_once(self, peer: Peer) -> bool:
        """Tell whether a publisher has kept what is to be done, and is no state: goals, commands.

        Of a command of ROS 1 nobody knows whether it is said again or comes again.
        """
        commands = peer.qos is not None and not self._keeps(peer)
        return (self._is_named_goal() or commands) and peer.latching and not self.dry_run

    def _is_named_goal(self) -> bool:
        is_action = self.stream.stages[0].settings.kind is StreamKind.ACTION
        return is_action or bool(self.stream.action)

    def _is_momentary(self, peer: Peer) -> bool:
        """Tell whether what a publisher says is a command: neither a goal nor a state."""
        return not (self._is_named_goal() or self.stream.done or self._keeps(peer))

    def _keeps(self, peer: Peer) -> bool:
        """Tell whether a late subscriber is told the last message: only of what is a state."""
        first = self.stream.stages[0]
        if first.coordination is CoordinationKind.GRCN:
            return first.settings.kind is StreamKind.STATE
        codec = codec_of(peer.info, self._transport.encoding)
        return codec is None or codec.is_limit

    def _learn(self, peer: Peer) -> bool:
        fits = self.dry_run or self._md5sum in ("", peer.info.md5sum)
        if not (fits and self._ends.learn(peer.info)):
            told = "%s: %s has another type, %s"
            log.error(told, self.stream.topic, peer.node, peer.info.type)
            return False
        self._info = peer.info
        codec = codec_of(peer.info, self._transport.encoding)
        if codec:
            self._learned(codec)
        return True

    def _learn_standard(self) -> None:
        """Learn the plan's type although no publisher has told what its messages are."""
        info = standard_info(self.stream.type, self._transport.encoding)
        if info:
            self._learn(Peer("", info))

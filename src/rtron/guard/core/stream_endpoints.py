"""The endpoints of one stream: which publishers it accepts, and as which flow."""

import logging
from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.latched_messages import LatchedMessageFilter
from rtron.guard.core.message_types import codec_of, standard_info
from rtron.guard.core.observations import Observations
from rtron.guard.core.printable import printable
from rtron.guard.core.stream_outputs import StreamOutputs
from rtron.guard.core.stream_settings import rules_md5sum, with_unapproved
from rtron.guard.transport.common.protocol import (
    ConnectHandler,
    MessageHandler,
    Peer,
    Transport,
    TypeInfo,
)
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
    matches_node,
)

log = logging.getLogger(__name__)

_MAX_NAME_LENGTH = 128
_MAX_STRANGERS = 32


class StreamEndpoints(ABC):
    """Subscribes to the private topic of each flow, and publishes the private output.

    A message on the public topic belongs to the flow `unapproved`.
    """

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        observations: Observations,
        handover: HandoverState,
        *,
        dry_run: bool,
    ) -> None:
        self.spec = self._with_defaults(stream)
        self.nodes = tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)
        self.strangers: dict[str, int] = {}
        self.dry_run = dry_run
        self._transport = transport
        self._outputs = StreamOutputs(self.spec, self.nodes, transport)
        self._latch_filter = LatchedMessageFilter(stream.topic, handover)
        self._rules_md5sum = rules_md5sum(stream, observations)
        self._type_info: TypeInfo | None = None

    @abstractmethod
    def _receive(self, flow: str, message: bytes) -> object:
        """Take a message of a flow."""

    @abstractmethod
    def _on_action_done(self, message: bytes) -> None:
        """Take a message which reports that an action is done."""

    @abstractmethod
    def _on_codec(self, codec: VelocityCodec) -> None:
        """Take the codec of the velocities in the stream's messages."""

    def set_listeners(
        self, on_type: Callable[[TypeInfo], None], on_sent: Callable[[str, bytes], None]
    ) -> None:
        """Call `on_type` when the type is learned, and `on_sent` with each message and its flow."""
        self._outputs.set_listeners(on_type, on_sent)

    def _with_defaults(self, stream: Stream) -> Stream:
        """Return the stream with all that the guard adds to the plan."""
        return with_unapproved(stream)

    def _open_endpoints(self) -> None:
        if self.spec.mode is Mode.ENFORCE:
            self._outputs.open()
            for flow in self.spec.flows:
                topic = flow_topic(self.spec.topic, flow.name)
                self._subscribe(topic, partial(self._connect_flow, flow), (flow.publisher,))
        self._subscribe(self.spec.topic, self._connect_public)
        self._subscribe_done()

    def _subscribe_done(self) -> None:
        if self.spec.done:
            self._subscribe_successors(self.spec.done, "", self._connect_done)

    def _subscribe_successors(self, topic: str, type: str, connect: ConnectHandler) -> None:
        awaited = self.spec.successors
        self._transport.subscribe(self.nodes[0], topic, type, connect, publishers=awaited)

    def _subscribe(
        self, topic: str, connect: ConnectHandler, publishers: tuple[str, ...] = ()
    ) -> None:
        self._transport.subscribe(
            self.nodes[0],
            topic,
            self.spec.type,
            connect,
            is_command=self._is_momentary,
            publishers=publishers,
        )

    def _connect_flow(self, flow: Flow, peer: Peer) -> MessageHandler | None:
        if not (peer.verified and matches_node(flow.publisher, peer.node)):
            return self._connect_stranger(peer, f"on the private topic of {flow.name}")
        if not self._learn_type(peer):
            return None
        self._outputs.set_latching(
            flow.name, latching=peer.latching and self._is_latched_state(peer)
        )
        if peer.qos:
            self._outputs.offer(flow.name, peer.qos)
        return self._receiver_for(flow.name, peer)

    def _connect_public(self, peer: Peer) -> MessageHandler | None:
        if self.spec.mode is Mode.OBSERVE:
            known_flows = (f for f in self.spec.flows if matches_node(f.publisher, peer.node))
            flow = next(known_flows, None)
            if flow is not None:
                return self._receiver_for(flow.name, peer) if self._learn_type(peer) else None
        return self._connect_stranger(peer, "under the public name")

    def _connect_done(self, peer: Peer) -> MessageHandler | None:
        is_successor = any(matches_node(each, peer.node) for each in self.spec.successors)
        return self._on_action_done if peer.verified and is_successor else None

    def _connect_stranger(self, peer: Peer, where: str) -> MessageHandler | None:
        if not self.spec.block_unapproved and not self._learn_type(peer):
            return None
        name = printable(peer.node)[:_MAX_NAME_LENGTH]
        if name in self.strangers or len(self.strangers) < _MAX_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        log.warning("%s: unapproved publisher %s %s", self.spec.topic, name, where)
        if self.dry_run and not self._outputs.has_type(peer.info):
            return None
        return self._receiver_for(UNAPPROVED, peer)

    def _receiver_for(self, flow: str, peer: Peer) -> MessageHandler:
        """Return the handler of a publisher's messages, with a filter for latched ones.

        The filter remembers nothing of blocked publishers: there may be any number of them.
        """
        take = partial(self._receive, flow)
        is_blocked = flow == UNAPPROVED and self.spec.block_unapproved
        once = self._needs_latch_filter(peer) and not is_blocked
        return self._latch_filter.filter(peer.node, take) if once else take

    def _needs_latch_filter(self, peer: Peer) -> bool:
        """Return whether a publisher's latched messages are goals or commands, and no state.

        Of a latched command in ROS 1 nobody knows whether it was sent again or is old.
        """
        commands = peer.qos is not None and not self._is_latched_state(peer)
        return (self._is_goal() or commands) and peer.latching and not self.dry_run

    def _is_goal(self) -> bool:
        is_action = self.spec.stages[0].settings.kind is StreamKind.ACTION
        return is_action or bool(self.spec.action)

    def _is_momentary(self, peer: Peer) -> bool:
        """Return whether a publisher's messages are commands: neither goals nor states."""
        return not (self._is_goal() or self.spec.done or self._is_latched_state(peer))

    def _is_latched_state(self, peer: Peer) -> bool:
        """Return whether a late subscriber gets the last message: only that of a state."""
        first = self.spec.stages[0]
        if first.coordination_kind is CoordinationKind.GRCN:
            return first.settings.kind is StreamKind.STATE
        codec = codec_of(peer.info, self._transport.encoding)
        return codec is None or codec.is_limit

    def _learn_type(self, peer: Peer) -> bool:
        fits = self.dry_run or self._rules_md5sum in ("", peer.info.md5sum)
        if not (fits and self._outputs.learn(peer.info)):
            text = "%s: %s has another type, %s"
            log.error(text, self.spec.topic, peer.node, peer.info.type)
            return False
        self._type_info = peer.info
        codec = codec_of(peer.info, self._transport.encoding)
        if codec:
            self._on_codec(codec)
        return True

    def _learn_standard(self) -> None:
        """Learn the plan's type although no publisher has connected."""
        info = standard_info(self.spec.type, self._transport.encoding)
        if info:
            self._learn_type(Peer("", info))

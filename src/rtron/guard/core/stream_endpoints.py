"""The endpoints of one stream: which publishers it accepts, and as which flow."""

import logging
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.latched_messages import LatchedMessageFilter
from rtron.guard.core.message_types import codec_of, number_checker, standard_info
from rtron.guard.core.observations import Observations
from rtron.guard.core.printable import printable
from rtron.guard.core.stream_outputs import StreamOutputs, keeps_all
from rtron.guard.core.stream_settings import rules_md5sum
from rtron.guard.transport.common.protocol import (
    ConnectHandler,
    InputOptions,
    MessageHandler,
    Peer,
    Transport,
    TypeInfo,
)
from rtron.messages.common.finite_numbers import NUMERIC_COMMAND_TYPES
from rtron.messages.common.velocity import VELOCITY_TYPES
from rtron.vocabulary import (
    SUPERVISOR_NODE,
    UNAPPROVED,
    CoordinationKind,
    Flow,
    Mode,
    Stream,
    StreamKind,
    flow_topic,
    matches_node,
    normalise_type,
)

if TYPE_CHECKING:
    from rtron.guard.core.stream import GuardedStream

log = logging.getLogger(__name__)

_MAX_NAME_LENGTH = 128
_MAX_STRANGERS = 32


@dataclass(frozen=True, slots=True)
class StreamContext:
    """What the streams of a guard share; `handover` is what the guard before has left."""

    transport: Transport
    observations: Observations
    handover: HandoverState
    dry_run: bool = False


@dataclass(frozen=True, slots=True)
class InputRules:
    """What a kind of stream does with its inputs that others do not.

    `receiver` returns what takes the messages of a flow's publisher, in place of
    `GuardedStream.receive`. Without `latches` late subscribers get no message, whatever its type.
    """

    receiver: Callable[[str, Peer], MessageHandler] | None = None
    latches: bool = True


class StreamEndpoints:
    """Subscribes to the private topic of each flow, and publishes the private output.

    A message on the public topic belongs to the flow `unapproved`.
    """

    def __init__(
        self,
        spec: Stream,
        nodes: tuple[str, ...],
        listener: "GuardedStream",
        rules: InputRules,
        context: StreamContext,
    ) -> None:
        self.spec = spec
        self.outputs = StreamOutputs(spec, nodes, context.transport)
        self.strangers: dict[str, int] = {}
        self.type_info: TypeInfo | None = None
        self.rules_md5sum = rules_md5sum(spec, context.observations)
        self._node = nodes[0]
        self._listener = listener
        self._rules = rules
        self._transport = context.transport
        self._dry_run = context.dry_run
        self._publisher_counts: Counter[str] = Counter()
        self._latch_filter = LatchedMessageFilter(spec.topic, context.handover)

    def open(self) -> None:
        """Join the graph."""
        if self.spec.mode is Mode.ENFORCE:
            self.outputs.open()
            for flow in self.spec.flows:
                topic = flow_topic(self.spec.topic, flow.name)
                where = f"on the private topic of {flow.name}"
                flow_of = partial(self._private_flow, flow)
                self._subscribe(topic, flow_of, where, (flow.publisher,))
        self._subscribe(self.spec.topic, self._public_flow, "under the public name")

    def update(self, spec: Stream, md5sum: str) -> None:
        """Go on with other settings, and rules for messages of this MD5 sum."""
        self.spec, self.rules_md5sum = spec, md5sum

    def subscribe_successors(self, topic: str, type: str, connect: ConnectHandler) -> None:
        """Subscribe to what the successors publish; nobody else is connected."""

        def connect_successor(peer: Peer) -> MessageHandler | None:
            return connect(peer) if self.is_successor(peer) else None

        options = InputOptions(publishers=self.spec.successors)
        self._transport.subscribe(self._node, topic, type, connect_successor, options)

    def is_successor(self, peer: Peer) -> bool:
        """Tell whether a publisher is one of the planned successors."""
        return peer.verified and any(matches_node(s, peer.node) for s in self.spec.successors)

    def fits_rules(self, info: TypeInfo) -> bool:
        """Tell whether the mission's rules can look into messages of a type."""
        return self._dry_run or self.rules_md5sum in ("", info.md5sum)

    def count_stranger(self, name: str) -> None:
        """Count a connection of a node that the plan does not approve."""
        if name in self.strangers or len(self.strangers) < _MAX_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1

    def filter_latched(self, peer: Peer, take: MessageHandler) -> MessageHandler:
        """Return what takes the messages of a publisher: a latched goal only once."""
        if not self._needs_latch_filter(peer):
            return take
        return self._latch_filter.filter(peer.node, take)

    def learn_standard(self) -> None:
        """Learn the plan's type although no publisher has told what its messages are."""
        info = standard_info(self.spec.type, self._transport.encoding)
        if info:
            self._learn_type(Peer("", info))

    def _subscribe(
        self,
        topic: str,
        flow_of: Callable[[Peer], Flow | None],
        where: str,
        publishers: tuple[str, ...] = (),
    ) -> None:
        """Subscribe to a topic; `flow_of` returns the planned flow of a publisher, or None."""
        self._transport.subscribe(
            self._node,
            topic,
            self.spec.type,
            lambda peer: self._connect(flow_of(peer), peer, where),
            InputOptions(
                is_command=self._is_momentary,
                publishers=publishers,
                queue_size=self.spec.queue_size,
                keep_all=keeps_all(self.spec),
                on_missed=lambda peer, number: self._count_missed(flow_of(peer), peer, number),
                on_lost=lambda peer: self._lose(flow_of(peer)),
            ),
        )

    def _count_missed(self, flow: Flow | None, peer: Peer, number: int) -> None:
        name = _name_of(flow) if peer.verified else UNAPPROVED
        self._listener.count_lost(name, number)

    def _private_flow(self, flow: Flow, peer: Peer) -> Flow | None:
        return flow if peer.verified and matches_node(flow.publisher, peer.node) else None

    def _public_flow(self, peer: Peer) -> Flow | None:
        """Return the flow of a publisher that is only watched: nobody was moved elsewhere."""
        flows = self.spec.flows if self.spec.mode is Mode.OBSERVE else ()
        return next((f for f in flows if matches_node(f.publisher, peer.node)), None)

    def _connect(self, flow: Flow | None, peer: Peer, where: str) -> MessageHandler | None:
        receive = self._connect_flow(flow, peer) if flow else self._connect_stranger(peer, where)
        if receive is not None:
            self._publisher_counts[_name_of(flow)] += 1
            if flow or not self.spec.block_unapproved:
                self._listener.resume_order()
        return receive

    def _lose(self, flow: Flow | None) -> None:
        """Look a moment later whether a flow has any publisher left: one may just be renewed."""
        name = _name_of(flow)
        self._publisher_counts[name] -= 1
        if not self._publisher_counts[name]:
            self._transport.call_at(self._transport.now(), partial(self._forget_if_lost, name))

    def _forget_if_lost(self, name: str) -> None:
        if not self._publisher_counts[name]:
            self._listener.forget_flow(name)

    def _connect_flow(self, flow: Flow, peer: Peer) -> MessageHandler | None:
        if not self._learn_type(peer):
            return None
        if self.spec.mode is Mode.OBSERVE:
            return self._receiver_for(flow.name, peer)
        self.outputs.set_latching(
            flow.name, latching=peer.latching and self._is_latched_state(peer)
        )
        if peer.qos:
            self.outputs.offer(flow.name, peer.qos)
        return self._receiver_for(flow.name, peer)

    def _connect_stranger(self, peer: Peer, where: str) -> MessageHandler | None:
        if peer.verified and peer.node == SUPERVISOR_NODE:
            return None  # it stops who listens to the public name
        if not self.spec.block_unapproved and not self._learn_type(peer):
            return None
        name = printable(peer.node)[:_MAX_NAME_LENGTH]
        self.count_stranger(name)
        log.warning("%s: unapproved publisher %s %s", self.spec.topic, name, where)
        if self._dry_run and not self.outputs.has_type(peer.info):
            return None
        return self._receiver_for(UNAPPROVED, peer)

    def _receiver_for(self, flow: str, peer: Peer) -> MessageHandler:
        """Return the handler of a publisher's messages, with a filter for latched ones.

        The filter remembers nothing of blocked publishers: there may be any number of them.
        """
        take = partial(self._listener.receive, flow)
        if flow == UNAPPROVED and self.spec.block_unapproved:
            return take
        if self._rules.receiver:
            return self._rules.receiver(flow, peer)
        return self.filter_latched(peer, take)

    def _needs_latch_filter(self, peer: Peer) -> bool:
        """Return whether a publisher latches goals; old commands do not come this far."""
        return self._is_goal() and peer.latching and not self._dry_run

    def _is_goal(self) -> bool:
        is_action = self.spec.stages[0].settings.kind is StreamKind.ACTION
        return is_action or bool(self.spec.action or self.spec.done)

    def _is_momentary(self, peer: Peer) -> bool:
        """Return whether a publisher's messages are commands: neither goals nor states."""
        return not (self._is_goal() or self._is_latched_state(peer))

    def _is_latched_state(self, peer: Peer) -> bool:
        """Return whether a late subscriber gets the last message: only that of a state."""
        if not self._rules.latches:
            return False
        first = self.spec.stages[0]
        if first.coordination_kind is CoordinationKind.GRCN:
            return first.settings.kind is StreamKind.STATE
        if normalise_type(peer.info.type) in NUMERIC_COMMAND_TYPES:
            return False
        codec = codec_of(peer.info, self._transport.encoding)
        return codec is None or codec.is_limit

    def _learn_type(self, peer: Peer) -> bool:
        if not (self.fits_rules(peer.info) and self.outputs.learn(peer.info)):
            text = "%s: %s has another type, %s"
            log.error(text, self.spec.topic, peer.node, peer.info.type)
            return False
        self.type_info = peer.info
        if normalise_type(peer.info.type) in VELOCITY_TYPES:
            self._listener.learn_codec(codec_of(peer.info, self._transport.encoding))
        elif normalise_type(peer.info.type) in NUMERIC_COMMAND_TYPES:
            self._listener.learn_numbers(number_checker(peer.info, self._transport.encoding))
        return True


def _name_of(flow: Flow | None) -> str:
    return flow.name if flow else UNAPPROVED

"""Subscriptions to events and frames, which update the observations."""

import logging
from collections.abc import Callable
from functools import partial

from rtron.errors import WireError
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.losses import Losses
from rtron.guard.core.message_types import stamp_of
from rtron.guard.core.observations import EventSource, Observations
from rtron.guard.transport.common.protocol import InputOptions, MessageHandler, Peer, Transport
from rtron.policies.velocity_limit.frame_counter import NO_STAMP
from rtron.vocabulary import PRIVATE_ROOT, FpsMonitor, WatchedFlow, matches_node


class StampFilter:
    """Drops repeated events of one publisher, which have the stamp of the one before.

    A node that repeats its last message looks alive, but says nothing new. A message without a
    stamp, or with stamp 0, is always new.
    """

    def __init__(self, stamp: Callable[[bytes], int]) -> None:
        self._stamp = stamp
        self._last_stamp = NO_STAMP

    def is_new(self, message: bytes) -> bool:
        """Return whether a message does not repeat the last one; one without a header is new."""
        try:
            stamp = self._stamp(message)
        except WireError:
            return True
        is_repeated = stamp == self._last_stamp != NO_STAMP
        self._last_stamp = stamp
        return not is_repeated


log = logging.getLogger(__name__)

_FRAME_BEGIN = 256
"""What is read of a picture, bytes: its header has the stamp."""
FrameHandler = Callable[[int, int], None]
"""Takes a frame's stamp and its arrival, ns."""


class ObservationInputs:
    """Subscribes to the sources of observations; calls `on_change` when these may have changed."""

    def __init__(
        self,
        transport: Transport,
        observations: Observations,
        on_change: Callable[[], None],
    ) -> None:
        self._transport = transport
        self._observations = observations
        self._on_change = on_change
        self._log_throttle = LogThrottle()
        self.losses = {each.topic: Losses(each.topic) for each in observations.events}
        """The events that did not reach the guard, by topic."""
        self.on_event: Callable[[str, Peer, bytes], None] = _ignore_event
        """Called with the topic, the publisher and the message of each event."""

    def open(self) -> None:
        """Join the graph."""
        for source in self._observations.events:
            self._open_event(source)
        for monitor in self._observations.monitors:
            self._open_monitor(monitor)

    def _open_event(self, source: EventSource) -> None:
        node = f"{PRIVATE_ROOT}/{self._observations.node}"
        connect = partial(self._connect_event, source)
        options = InputOptions(
            publishers=(source.publisher,),
            keep_all=True,
            on_missed=partial(self._on_event_missed, source.topic),
            on_lost=partial(self._on_event_lost, source),
        )
        for topic in self._observations.publisher_topics.topics_of(source.topic, source.publisher):
            self._transport.subscribe(node, topic, source.type, connect, options)

    def _open_monitor(self, plan: FpsMonitor) -> None:
        monitor = self._observations.rates.monitors[plan.id]
        flow = WatchedFlow(name=plan.id, topic=plan.topic, publisher=plan.node)
        self._open_frames(plan, flow, monitor.add_frame)
        if plan.camera:
            self._open_frames(plan, plan.camera, monitor.add_camera_frame)

    def _open_frames(self, plan: FpsMonitor, flow: WatchedFlow, on_frame: FrameHandler) -> None:
        connect = partial(self._connect_frames, flow, on_frame)
        for topic in self._observations.publisher_topics.topics_of(flow.topic, flow.publisher):
            node, awaited = f"{PRIVATE_ROOT}/{plan.id}", (flow.publisher,)
            options = InputOptions(publishers=awaited, begin=_FRAME_BEGIN)
            self._transport.subscribe(node, topic, "", connect, options)

    def _connect_event(self, source: EventSource, peer: Peer) -> MessageHandler | None:
        if not _is_planned_publisher(source.publisher, peer, source.topic):
            return None
        if source.md5sum not in ("", peer.info.md5sum):
            text = "%s: %s publishes another version of %s than the plan's rules are written for"
            log.error(text, source.topic, peer.node, peer.info.type)
            return None
        for bit in source.bits:
            bit.add_publisher()
        self._update_mission()
        filter = StampFilter(stamp_of(peer.info, self._transport.encoding))
        return partial(self._on_event, source, peer, filter)

    def _on_event(
        self, source: EventSource, peer: Peer, stamp_filter: StampFilter, message: bytes
    ) -> None:
        if not stamp_filter.is_new(message):
            return
        self.on_event(source.topic, peer, message)
        now = self._transport.now()
        for bit, judgement in zip(source.bits, source.judgements_of(message), strict=True):
            truth = None if isinstance(judgement, str) else judgement
            self._observations.mission.observe(bit.flow.name, truth, now)
            if truth is None and self._log_throttle.allows(bit.flow.name, now):
                log.warning(
                    "%s: the value of %s is unknown: %s", source.topic, bit.flow.name, judgement
                )
        self._update_mission()

    def _on_event_lost(self, source: EventSource, peer: Peer) -> None:
        log.warning("%s: %s is gone", source.topic, peer.node)
        for bit in source.bits:
            bit.remove_publisher()
        self._update_mission()

    def _on_event_missed(self, topic: str, peer: Peer, count: int) -> None:
        """Count events that were lost: a rule may have needed them."""
        self.losses[topic].count(peer.node, count)

    def _update_mission(self) -> None:
        self._observations.mission.update(self._transport.now())
        self._on_change()

    def _connect_frames(
        self, flow: WatchedFlow, on_frame: FrameHandler, peer: Peer
    ) -> MessageHandler | None:
        if not _is_planned_publisher(flow.publisher, peer, flow.topic):
            return None
        stamp = stamp_of(peer.info, self._transport.encoding)
        return partial(self._on_frame, stamp, on_frame)

    def _on_frame(
        self, stamp: Callable[[bytes], int], on_frame: FrameHandler, message: bytes
    ) -> None:
        try:
            on_frame(stamp(message), self._transport.now())
        except WireError as error:
            if self._log_throttle.allows(on_frame, self._transport.now()):
                log.warning("a frame does not count: %s", error)
        self._on_change()


def _is_planned_publisher(publisher: str, peer: Peer, topic: str) -> bool:
    """Return whether a peer is the publisher that the plan names; log it if not."""
    is_planned = peer.verified and matches_node(publisher, peer.node)
    if not is_planned:
        log.warning("%s: %s is ignored: it is not %s", topic, peer.node, publisher)
    return is_planned


def _ignore_event(_topic: str, _peer: Peer, _message: bytes) -> None:
    """Let nobody know of an event."""

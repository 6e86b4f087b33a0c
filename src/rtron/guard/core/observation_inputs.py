"""Listening to events and frames: what the senses are told, and when others must look again."""

import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

from rtron.errors import WireError
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.message_types import stamp_of
from rtron.guard.core.observations import EventSource, Senses
from rtron.guard.news import News
from rtron.guard.transport.common.protocol import Peer, Receive, Transport
from rtron.vocabulary import PRIVATE_ROOT, FpsMonitor, WatchedFlow, names_node

log = logging.getLogger(__name__)

Note = Callable[[int, int], None]
"""Takes a frame's stamp and its arrival, ns."""


@dataclass(frozen=True, slots=True)
class Ways:
    """Where a publisher is heard: an approved one of an enforced topic speaks on a private one."""

    private: dict[tuple[str, str], str]

    def of(self, topic: str, publisher: str) -> Iterable[str]:
        """Return the topics to listen to."""
        yield topic
        for (guarded, approved), private in self.private.items():
            if guarded == topic and (
                names_node(approved, publisher) or names_node(publisher, approved)
            ):
                yield private


class Watching:
    """Subscribes what the senses need, and calls `changed` when they may say something else."""

    def __init__(
        self, transport: Transport, senses: Senses, ways: Ways, changed: Callable[[], None]
    ) -> None:
        self._transport = transport
        self._senses = senses
        self._ways = ways
        self._changed = changed
        self._seldom = Seldom()

    def open(self) -> None:
        """Join the graph."""
        for source in self._senses.events:
            self._open_event(source)
        for monitor in self._senses.monitors:
            self._open_monitor(monitor)

    def _open_event(self, source: EventSource) -> None:
        node = f"{PRIVATE_ROOT}/{self._senses.node}"
        connect, lost = partial(self._connect_event, source), partial(self._event_lost, source)
        for topic in self._ways.of(source.topic, source.publisher):
            awaited = (source.publisher,)
            self._transport.subscribe(node, topic, source.type, connect, lost, publishers=awaited)

    def _open_monitor(self, plan: FpsMonitor) -> None:
        monitor = self._senses.rates.monitors[plan.id]
        flow = WatchedFlow(name=plan.id, topic=plan.topic, publisher=plan.node)
        self._open_frames(plan, flow, monitor.frame)
        if plan.camera:
            self._open_frames(plan, plan.camera, monitor.camera_frame)

    def _open_frames(self, plan: FpsMonitor, flow: WatchedFlow, note: Note) -> None:
        connect = partial(self._connect_frames, flow, note)
        for topic in self._ways.of(flow.topic, flow.publisher):
            node, awaited = f"{PRIVATE_ROOT}/{plan.id}", (flow.publisher,)
            self._transport.subscribe(node, topic, "", connect, publishers=awaited)

    def _connect_event(self, source: EventSource, peer: Peer) -> Receive | None:
        if not _is(source.publisher, peer, source.topic):
            return None
        if source.md5sum not in ("", peer.info.md5sum):
            told = "%s: %s publishes another version of %s than the plan's rules are written for"
            log.error(told, source.topic, peer.node, peer.info.type)
            return None
        for bit in source.bits:
            bit.found()
        self._look_again()
        news = News(stamp_of(peer.info, self._transport.encoding))
        return partial(self._event, source, news)

    def _event(self, source: EventSource, news: News, message: bytes) -> None:
        if not news.is_new(message):
            return
        now = self._transport.now()
        for bit, found in zip(source.bits, source.judged(message), strict=True):
            truth = None if isinstance(found, str) else found
            self._senses.mission.observe(bit.flow.name, truth, now)
            if truth is None and self._seldom.may_say(bit.flow.name, now):
                log.warning("%s: what %s says is not known: %s", source.topic, bit.flow.name, found)
        self._look_again()

    def _event_lost(self, source: EventSource, peer: Peer) -> None:
        log.warning("%s: %s is gone", source.topic, peer.node)
        for bit in source.bits:
            bit.lost()
        self._look_again()

    def _look_again(self) -> None:
        self._senses.mission.update(self._transport.now())
        self._changed()

    def _connect_frames(self, flow: WatchedFlow, note: Note, peer: Peer) -> Receive | None:
        if not _is(flow.publisher, peer, flow.topic):
            return None
        stamp = stamp_of(peer.info, self._transport.encoding)
        return partial(self._frame, stamp, note)

    def _frame(self, stamp: Callable[[bytes], int], note: Note, message: bytes) -> None:
        try:
            note(stamp(message), self._transport.now())
        except WireError as error:
            if self._seldom.may_say(note, self._transport.now()):
                log.warning("a frame does not count: %s", error)
        self._changed()


def _is(publisher: str, peer: Peer, topic: str) -> bool:
    """Tell whether a peer is the publisher that the plan names; say so if it is not."""
    known = peer.verified and names_node(publisher, peer.node)
    if not known:
        log.warning("%s: %s is not heard: it is not %s", topic, peer.node, publisher)
    return known

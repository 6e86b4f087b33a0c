"""The guard's own connections to publishers that go past it: what they say is answered at once."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.audit.common.audit_response import ListenRequest, ListenToPublisher
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.protocol import MessageHandler, Peer
from rtron.guard.transport.ros1.handshake import TopicRequest
from rtron.guard.transport.ros1.subscription import PublisherLink
from rtron.vocabulary import GUARD_NODE

_MAX_LINKS = 16
_THREADS = 2


@dataclass(slots=True)
class _IntruderLink:
    stream: str
    link: PublisherLink
    last_message_at: int | None = None


class IntruderLinks:
    """Links to at most 16 publishers, by topic and address; the oldest makes room.

    An `IntruderListener`; a link lasts as long as its stream is stopped.
    """

    def __init__(self, loop: EventLoop, master: str, response: AlarmResponse) -> None:
        self._loop = loop
        self._master = master
        self._response = response
        self._links: dict[tuple[str, str], _IntruderLink] = {}
        self._workers = ThreadPoolExecutor(_THREADS, thread_name_prefix="audit-hear")

    def open(self) -> None:
        """Do nothing: the audit says to whom."""

    def follow(self, request: ListenRequest) -> None:
        """Listen to a publisher, if it goes past a stream that is stopped."""
        stopped = self._response.stopped_streams
        if isinstance(request, ListenToPublisher) and request.stream in stopped:
            self._listen(request)

    def update(self) -> None:
        """Listen no more to those who do not go past a stream that is stopped."""
        stopped = self._response.stopped_streams
        for key in [key for key, each in self._links.items() if each.stream not in stopped]:
            self._close(key)

    def _listen(self, publisher: ListenToPublisher) -> None:
        key = (publisher.topic, publisher.uri)
        known = self._links.get(key)
        if known and known.link.is_connected:
            return
        if known is None and len(self._links) == _MAX_LINKS:
            self._close(next(iter(self._links)))
        elif known:
            self._close(key)
        request = TopicRequest(GUARD_NODE, publisher.topic, "", self._master)
        on_connect = partial(self._on_connect, key)
        link = PublisherLink(self._loop, self._workers, request, publisher.uri, on_connect)
        self._links[key] = _IntruderLink(publisher.stream, link)

    def silence(self, stream: str) -> int | None:
        """Return for how long (ns) no intruder was heard on a stream; None if none ever was."""
        times = (each.last_message_at for each in self._links.values() if each.stream == stream)
        known = [each for each in times if each is not None]
        return self._loop.now() - max(known) if known else None

    def close(self) -> None:
        """Listen to nobody any more."""
        for key in list(self._links):
            self._close(key)
        self._workers.shutdown(wait=False, cancel_futures=True)

    def _on_connect(self, key: tuple[str, str], peer: Peer) -> MessageHandler | None:
        del peer
        return partial(self._receive, self._links[key]) if key in self._links else None

    def _receive(self, link: _IntruderLink, message: bytes) -> None:
        link.last_message_at = self._loop.now()
        self._response.answer(link.stream, message)

    def _close(self, key: tuple[str, str]) -> None:
        self._links.pop(key).link.close()

"""Rounds of questions: everybody is asked once a period, evenly spread, and nobody is waited for.

Half of them are asked in one go, and their answers looked for in one go, not when each arrives: a
loop that is woken by every answer of forty nodes needs twice as much of the processor.
"""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.errors import RTronError
from rtron.guard.audit.ros1.xmlrpc_poller import ServerAddress, XmlRpcPoller
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND

SLOTS = 2
"""How many turns a round has."""
_RESPONSE_TIMEOUT = SECOND
_COLLECTIONS_PER_SLOT = 5
"""How often a turn may look for answers, the asking included."""


@dataclass(slots=True, kw_only=True, eq=False)
class PollTarget:
    """Whom to ask, and who takes the answer.

    Nobody is asked while `server` is not known, nor before `not_before` (ns).
    """

    poller: XmlRpcPoller
    on_response: Callable[[bytes], None]
    on_failure: Callable[[Exception], None]
    server: ServerAddress | None = None
    not_before: int = 0


class PollSchedule:
    """Asks everybody once in `period` (ns); an answer that takes longer than 1 s is none."""

    def __init__(self, loop: EventLoop, period: int) -> None:
        self._loop = loop
        self._step = max(1, period // SLOTS)
        self._slots: list[list[PollTarget]] = [[] for _ in range(SLOTS)]
        self._slot = 0
        self._pending: list[PollTarget] = []
        self._due = 0
        self._collection_count = 0
        self._closed = False

    def start(self) -> None:
        """Ask from now on."""
        self._due = self._loop.now()
        self._tick()

    def add(self, target: PollTarget) -> None:
        """Ask one more."""
        min(self._slots, key=len).append(target)

    def remove(self, target: PollTarget) -> None:
        """Ask one no more."""
        for group in (*self._slots, self._pending):
            if target in group:
                group.remove(target)
        target.poller.close()

    def close(self) -> None:
        """Ask nobody any more."""
        self._closed = True
        for target in [each for turn in self._slots for each in turn]:
            self.remove(target)

    def _tick(self) -> None:
        if self._closed:
            return
        now = self._loop.now()
        self._due = max(self._due + self._step, now)
        self._loop.call_at(self._due, self._tick)
        self._slot = (self._slot + 1) % SLOTS
        self._collect(now)
        for target in list(self._slots[self._slot]):
            self._send_request(target, now)
        self._collection_count = 0
        self._loop.call_at(now + self._step // _COLLECTIONS_PER_SLOT, self._collect_soon)

    def _collect_soon(self) -> None:
        """Look for answers, and for the late ones a little later."""
        if self._closed:
            return
        now = self._loop.now()
        self._collect(now)
        self._collection_count += 1
        if self._pending and self._collection_count < _COLLECTIONS_PER_SLOT - 1:
            self._loop.call_at(now + self._step // _COLLECTIONS_PER_SLOT, self._collect_soon)

    def _collect(self, now: int) -> None:
        waiting, self._pending = self._pending, []
        self._pending += [peer for peer in waiting if not self._is_settled(peer, now)]

    def _send_request(self, target: PollTarget, now: int) -> None:
        if target.server is None or target.poller.pending_since or now < target.not_before:
            return
        try:
            target.poller.send_request(target.server, now)
        except (OSError, RTronError) as error:
            target.poller.close()
            target.on_failure(error)
        else:
            self._pending.append(target)

    def _is_settled(self, target: PollTarget, now: int) -> bool:
        """Look whether an answer is there; tell whether there is nothing more to look for."""
        pending_since = target.poller.pending_since
        try:
            body = target.poller.poll()
        except (OSError, RTronError) as error:
            target.on_failure(error)
            return True
        if body is not None:
            target.on_response(body)
        elif pending_since and now - pending_since > _RESPONSE_TIMEOUT:
            target.poller.close()
            target.on_failure(TimeoutError("no answer within 1 s"))
            return True
        return body is not None or not pending_since

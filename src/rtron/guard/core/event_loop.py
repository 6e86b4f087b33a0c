"""One event loop for everything the guard does: sockets, timers, and answers from threads."""

import heapq
import logging
import selectors
import socket
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from typing import Protocol

from rtron.errors import RTronError
from rtron.guard.core.out_of_memory import end_starved

log = logging.getLogger(__name__)

Callback = Callable[[], None]


class Watched(Protocol):
    """What a selector can watch: a socket, or another descriptor."""

    def fileno(self) -> int:
        """Return the descriptor, negative when it is closed."""
        ...

    def close(self) -> None:
        """Close it."""
        ...


class Watch:
    """What to do when a socket can be read or written, and when serving it failed."""

    __slots__ = ("broken", "readable", "writable")

    def __init__(self, readable: Callback, broken: Callable[[Exception], None]) -> None:
        self.readable = readable
        self.writable: Callback | None = None
        self.broken = broken


class Loop:
    """A selector with timers; every callback runs in the thread of `run`.

    A callback that fails ends what it served (`Watch.broken`), never the loop.
    """

    def __init__(self) -> None:
        self._selector = selectors.DefaultSelector()
        self._timers: list[tuple[int, int, Callback]] = []
        self._order = count()
        self._posted: deque[Callback] = deque()
        self._after: list[Callback] = []
        self._running = False
        self._wake, self._waker = socket.socketpair()
        self._wake.settimeout(0)
        self._waker.settimeout(0)
        self.watch(self._wake, self._drain, self._ignore)

    now = staticmethod(time.monotonic_ns)

    def watch(self, sock: Watched, readable: Callback, broken: Callable[[Exception], None]) -> None:
        """Serve a non-blocking socket from now on."""
        self._selector.register(sock, selectors.EVENT_READ, Watch(readable, broken))

    def await_writable(self, sock: Watched, writable: Callback | None) -> None:
        """Call `writable` whenever the socket can be written, until told None."""
        watch: Watch = self._selector.get_key(sock).data
        watch.writable = writable
        write = selectors.EVENT_WRITE if writable else 0
        self._selector.modify(sock, selectors.EVENT_READ | write, watch)

    def pause(self, sock: Watched, duration: float) -> None:
        """Leave a socket alone for `duration` seconds; it keeps its place."""
        watch: Watch = self._selector.unregister(sock).data

        def resume() -> None:
            if sock.fileno() >= 0:
                self._selector.register(sock, selectors.EVENT_READ, watch)

        self.call_later(duration, resume)

    def forget(self, sock: Watched) -> None:
        """Serve a socket no more and close it; a second time does nothing."""
        with suppress(KeyError, ValueError):
            self._selector.unregister(sock)
        sock.close()

    def call_at(self, when: int, callback: Callback) -> None:
        """Call back once at `when` (ns)."""
        heapq.heappush(self._timers, (when, next(self._order), callback))

    def call_later(self, delay: float, callback: Callback) -> None:
        """Call back once after `delay` seconds."""
        self.call_at(self.now() + int(delay * 1e9), callback)

    def after(self, callback: Callback) -> None:
        """Call back once the present event has been dealt with."""
        self._after.append(callback)

    def post(self, callback: Callback) -> None:
        """Call back soon; the only call that other threads and signal handlers may make."""
        self._posted.append(callback)
        with suppress(OSError):
            self._waker.send(b"\0")

    def run(self) -> None:
        """Serve until `stop`."""
        self._running = True
        while self._running:
            self.step()

    def step(self, longest: float | None = None) -> None:
        """Wait for what comes next, `longest` seconds at most, and deal with it."""
        for key, events in self._selector.select(self._patience(longest)):
            self._serve(key.data, events)
        self._run_timers()
        self._flush()

    def stop(self) -> None:
        """End `run` after the present step."""
        self._running = False

    def close(self) -> None:
        """Close the loop's own sockets."""
        self.forget(self._wake)
        self._waker.close()
        self._selector.close()

    def _serve(self, watch: Watch, events: int) -> None:
        try:
            if events & selectors.EVENT_READ:
                watch.readable()
            if events & selectors.EVENT_WRITE and watch.writable:
                watch.writable()
            self._flush()
        except MemoryError:
            end_starved()
        except Exception as error:
            if not isinstance(error, (OSError, RTronError)):
                log.exception("internal error while serving a connection; it is closed")
            watch.broken(error)

    def _patience(self, longest: float | None) -> float | None:
        if not self._timers:
            return longest
        wait = max(0.0, (self._timers[0][0] - self.now()) / 1e9)
        return wait if longest is None else min(wait, longest)

    def _run_timers(self) -> None:
        now, due = self.now(), []
        while self._timers and self._timers[0][0] <= now:
            due.append(heapq.heappop(self._timers)[2])
        for callback in due:
            self._safely(callback)

    def _drain(self) -> None:
        with suppress(BlockingIOError):
            self._wake.recv(1 << 12)
        while self._posted:
            self._safely(self._posted.popleft())

    def _flush(self) -> None:
        while self._after:
            pending, self._after = self._after, []
            for callback in pending:
                self._safely(callback)

    def _safely(self, callback: Callback) -> None:
        try:
            callback()
        except MemoryError:
            end_starved()
        except Exception:
            log.exception("internal error in a callback")

    def _ignore(self, error: Exception) -> None:
        log.debug("waking up failed: %s", error)

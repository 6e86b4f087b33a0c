"""The guard's event loop: sockets, timers, callbacks from threads, and a thread beside it."""

import heapq
import logging
import select
import socket
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from threading import Event, Thread
from typing import Protocol

from rtron.errors import RTronError
from rtron.guard.system.process_attributes import exit_out_of_memory

log = logging.getLogger(__name__)

Callback = Callable[[], None]
_READ, _WRITE = select.EPOLLIN, select.EPOLLOUT
_READABLE, _WRITABLE = ~_WRITE, ~_READ
"""An error or a hang-up counts as both, as in `selectors`: reading or writing tells what it is."""

_MAX_EVENTS = 256
"""How many sockets are served between two looks at the timers."""


class Pollable(Protocol):
    """A socket, or another object with a file descriptor that a selector can watch."""

    def fileno(self) -> int:
        """Return the descriptor, negative when it is closed."""
        ...

    def close(self) -> None:
        """Close it."""
        ...


class IoHandler:
    """The callbacks for a socket that can be read or written, or whose handler failed."""

    __slots__ = ("on_error", "on_readable", "on_writable", "sock")

    def __init__(
        self, sock: Pollable, on_readable: Callback, on_error: Callable[[Exception], None]
    ) -> None:
        self.sock = sock
        self.on_readable = on_readable
        self.on_writable: Callback | None = None
        self.on_error = on_error


class EventLoop:
    """epoll(7) with timers; every callback runs in the thread of `run`.

    A callback that fails ends its own connection (`IoHandler.on_error`), never the loop.
    """

    def __init__(self) -> None:
        self._epoll = select.epoll()
        self._handlers: dict[int, IoHandler] = {}
        self._timers: list[tuple[int, int, Callback]] = []
        self._sequence = count()
        self._posted_callbacks: deque[Callback] = deque()
        self._after_event: list[Callback] = []
        self._when_idle: Callback | None = None
        self._running = False
        self._wake_receiver, self._wake_sender = socket.socketpair()
        self._wake_receiver.settimeout(0)
        self._wake_sender.settimeout(0)
        self.watch(self._wake_receiver, self._on_wake, self._on_wake_error)

    now = staticmethod(time.monotonic_ns)

    def watch(
        self, sock: Pollable, on_readable: Callback, on_error: Callable[[Exception], None]
    ) -> None:
        """Serve a non-blocking socket from now on."""
        self._register(IoHandler(sock, on_readable, on_error))

    def await_writable(self, sock: Pollable, on_writable: Callback | None) -> None:
        """Call `on_writable` whenever the socket can be written; None ends that."""
        self._handlers[sock.fileno()].on_writable = on_writable
        self._epoll.modify(sock, _READ | _WRITE if on_writable else _READ)

    def suspend(self, sock: Pollable, duration: float) -> None:
        """Stop watching a socket for `duration` seconds."""
        handler = self._unregister(sock)

        def resume() -> None:
            if sock.fileno() >= 0:
                self._register(handler)

        self.call_later(duration, resume)

    def unwatch(self, sock: Pollable) -> None:
        """Serve a socket no more; it stays open."""
        self._unregister(sock)

    def forget(self, sock: Pollable) -> None:
        """Stop watching a socket and close it; a second call does nothing."""
        with suppress(KeyError):  # it is not watched any more
            self._unregister(sock)
        sock.close()

    def call_at(self, when: int, callback: Callback) -> None:
        """Call back once at `when` (ns)."""
        heapq.heappush(self._timers, (when, next(self._sequence), callback))

    def call_later(self, delay: float, callback: Callback) -> None:
        """Call back once after `delay` seconds."""
        self.call_at(self.now() + int(delay * 1e9), callback)

    def call_after_event(self, callback: Callback) -> None:
        """Call back once the current event is handled."""
        self._after_event.append(callback)

    def call_when_idle(self, callback: Callback) -> None:
        """Call back once if nothing else is to be done right now; otherwise forget it."""
        self._when_idle = callback

    def post(self, callback: Callback) -> None:
        """Call back soon; the only call that other threads and signal handlers may make."""
        self._posted_callbacks.append(callback)
        with suppress(OSError):  # full: the loop wakes anyway; closed: it has ended
            self._wake_sender.send(b"\0")

    def run(self) -> None:
        """Serve until `stop`."""
        self._running = True
        while self._running:
            self.step()

    def step(self, longest_wait: float | None = None) -> None:
        """Wait for the next events, `longest_wait` seconds at most, and handle them."""
        when_idle, self._when_idle = self._when_idle, None
        wait = 0 if when_idle else self._timeout(longest_wait)
        ready = self._epoll.poll(wait, _MAX_EVENTS)
        for handler, events in [(self._handlers.get(fd), events) for fd, events in ready]:
            if handler:
                self._dispatch(handler, events)
        has_run = self._run_timers()
        self._flush()
        if when_idle and not (ready or has_run):
            self._call_safely(when_idle)

    def stop(self) -> None:
        """End `run` after the current step."""
        self._running = False

    def close(self) -> None:
        """Close the loop's own sockets."""
        self.forget(self._wake_receiver)
        self._wake_sender.close()
        self._epoll.close()

    def _register(self, handler: IoHandler) -> None:
        self._epoll.register(handler.sock, _READ)
        self._handlers[handler.sock.fileno()] = handler

    def _unregister(self, sock: Pollable) -> IoHandler:
        """Watch a socket no more; KeyError if it is not watched. epoll forgets closed ones."""
        fd = sock.fileno()
        if fd < 0:
            closed = (fd for fd, each in self._handlers.items() if each.sock is sock)
            return self._handlers.pop(next(closed, fd))
        handler = self._handlers.pop(fd)
        self._epoll.unregister(fd)
        return handler

    def _dispatch(self, handler: IoHandler, events: int) -> None:
        try:
            if events & _READABLE:
                handler.on_readable()
            if events & _WRITABLE and handler.on_writable:
                handler.on_writable()
            self._flush()
        except MemoryError:
            exit_out_of_memory()
        except Exception as error:
            if not isinstance(error, (OSError, RTronError)):
                log.exception("internal error while serving a connection; it is closed")
            handler.on_error(error)

    def _timeout(self, longest_wait: float | None) -> float | None:
        if not self._timers:
            return longest_wait
        wait = max(0.0, (self._timers[0][0] - self.now()) / 1e9)
        return wait if longest_wait is None else min(wait, longest_wait)

    def _run_timers(self) -> bool:
        """Call what is due; return whether anything was."""
        now, due = self.now(), []
        while self._timers and self._timers[0][0] <= now:
            due.append(heapq.heappop(self._timers)[2])
        for callback in due:
            self._call_safely(callback)
        return bool(due)

    def _on_wake(self) -> None:
        with suppress(BlockingIOError):  # an earlier wake-up has read all bytes
            self._wake_receiver.recv(1 << 12)
        while self._posted_callbacks:
            self._call_safely(self._posted_callbacks.popleft())

    def _flush(self) -> None:
        while self._after_event:
            pending, self._after_event = self._after_event, []
            for callback in pending:
                self._call_safely(callback)

    def _call_safely(self, callback: Callback) -> None:
        try:
            callback()
        except MemoryError:
            exit_out_of_memory()
        except Exception:
            log.exception("internal error in a callback")

    def _on_wake_error(self, error: Exception) -> None:
        log.debug("waking up failed: %s", error)


class BackgroundWorker:
    """A thread for work that may hang, as all work on files may; the loop never waits for it.

    Asked while it works, it works once more. It keeps no process from ending.
    """

    def __init__(self, work: Callable[[], None], name: str) -> None:
        self._work = work
        self._is_requested = Event()
        Thread(target=self._run, name=name, daemon=True).start()

    def request(self) -> None:
        """Ask for the work, now or as soon as the thread is free."""
        self._is_requested.set()

    def _run(self) -> None:
        while True:
            self._is_requested.wait()
            self._is_requested.clear()
            try:
                self._work()
            except Exception:
                log.exception("internal error in a thread of the guard; it goes on")

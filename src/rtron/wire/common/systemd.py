"""What a service reports to systemd (sd_notify(3)): lines of text in a datagram."""

import logging
import os
import socket
from collections.abc import MutableMapping

log = logging.getLogger(__name__)

_NS = 1000
"""Nanoseconds of a microsecond."""


class SystemdNotifier:
    """Reports readiness, health and the end of this process; nothing where nobody asks for it.

    No report makes the caller wait.
    """

    def __init__(self, address: str, watchdog: int) -> None:
        """Take the socket's address, and the longest time without a sign of life (ns; 0: any)."""
        self._address = f"\0{address[1:]}" if address.startswith("@") else address
        self._period = watchdog // 2
        self._due = 0
        self._status = ""
        self._is_ready = self._has_failed = False

    def report(self, now: int, status: str, *, is_well: bool) -> None:
        """Report a status that is new, and while all is well at `now` (ns) a sign of life.

        What could not be sent is sent with the next report.
        """
        is_due = is_well and self._period and now >= self._due
        is_new = is_well and not self._is_ready
        lines = [f"STATUS={status}"] if status != self._status else []
        lines += ["READY=1"] if is_new else []
        lines += ["WATCHDOG=1"] if is_due else []
        if lines and self._send("\n".join(lines)):
            self._status = status
            self._is_ready = self._is_ready or is_new
            self._due = now + self._period if is_due else self._due

    def stopping(self) -> None:
        """Report that this process ends."""
        self._send("STOPPING=1")

    def _send(self, text: str) -> bool:
        """Send a message without waiting; return whether it went out, or nobody asks for it."""
        if not self._address:
            return True
        kind = socket.SOCK_DGRAM | socket.SOCK_NONBLOCK | socket.SOCK_CLOEXEC
        try:
            with socket.socket(socket.AF_UNIX, kind) as sender:
                sender.sendto(text.encode(), self._address)
        except OSError as error:
            if not self._has_failed:
                log.warning("systemd does not get %r, tried again: %s", text, error)
            self._has_failed = True
            return False
        self._has_failed = False
        return True


def take_notifier(environment: MutableMapping[str, str]) -> SystemdNotifier:
    """Return what the environment asks for, and take it out: children are not to report."""
    address = environment.pop("NOTIFY_SOCKET", "")
    period = environment.pop("WATCHDOG_USEC", "")
    pid = environment.pop("WATCHDOG_PID", str(os.getpid()))
    if address and address[0] not in "/@":
        log.warning("NOTIFY_SOCKET is no Unix socket: systemd is told nothing")
        address = ""
    is_watched = period.isascii() and period.isdecimal() and pid == str(os.getpid())
    return SystemdNotifier(address, int(period) * _NS if is_watched else 0)

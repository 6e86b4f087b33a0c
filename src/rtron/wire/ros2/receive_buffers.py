"""Room in the sockets that a participant listens on.

Whoever joins a domain is told of every endpoint at once, several datagrams each, by all who are
there. The kernel's default, 212,992 bytes on Linux (socket(7), net.core.rmem_default), holds about
200 of them; what is lost is said again seconds later. The profiles of Fast DDS could ask for more,
but where the range of discovery is this machine the RMW replaces what they say of transports.
"""

from __future__ import annotations

import logging
import os
import socket
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

log = logging.getLogger(__name__)

RECEIVE_BUFFER_BYTES = 1 << 22
"""What is asked for, bytes; the kernel gives no more than net.core.rmem_max."""
_DESCRIPTORS = Path("/proc/self/fd")


@contextmanager
def large_receive_buffers() -> Iterator[None]:
    """Give every datagram socket that is opened in this block room for a crowd of messages."""
    before = _sockets()
    yield
    for inode, descriptor in _sockets().items():
        if inode not in before:
            _enlarge_buffer(descriptor)


def _sockets() -> dict[str, int]:
    """Return the descriptors of all our sockets, by what they are."""
    found: dict[str, int] = {}
    with suppress(OSError):
        for each in _DESCRIPTORS.iterdir():
            with suppress(OSError):
                found[str(each.readlink())] = int(each.name)
    return {what: descriptor for what, descriptor in found.items() if what.startswith("socket:")}


def _enlarge_buffer(descriptor: int) -> None:
    """Give a datagram socket room; it stays its owner's."""
    try:
        with socket.socket(fileno=os.dup(descriptor)) as sock:
            if sock.type == socket.SOCK_DGRAM:
                sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
    except OSError as error:
        log.debug("a socket keeps the room it has: %s", error)

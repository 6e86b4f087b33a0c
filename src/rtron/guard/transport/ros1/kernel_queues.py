"""How much of what was sent on a TCP connection the other end has not taken yet.

Our kernel knows what is not acknowledged (tcp(7), SIOCOUTQ). A frozen process acknowledges, since
its kernel does: on the same machine, sock_diag(7) tells what waits there. Else nobody does.
"""

import fcntl
import socket
import struct
import termios
from contextlib import suppress

from rtron.wire.ros1.network import HOST_NETWORK, Network

_COUNT = struct.Struct("=i")
_SOCK_DIAG_BY_FAMILY, _NLM_F_REQUEST = 20, 1
"""linux/sock_diag.h, linux/netlink.h"""
_HEADER = struct.Struct("=IHHII")
"""nlmsghdr: length, type, flags, sequence, port"""
_REQUEST = struct.Struct("=BBBBI2s2s16s16sIII")
"""inet_diag_req_v2: family, protocol, extensions, padding, states; ports, addresses, interface and
cookie of the socket (linux/inet_diag.h)"""
_RECEIVE_QUEUE_AT = _HEADER.size + 56
"""Where inet_diag_msg has `idiag_rqueue`, behind the family, the socket and `idiag_expires`."""
_ANY = 0xFFFFFFFF
_MOST_ANSWER = 1 << 12


class KernelQueues:
    """Asks the kernel about connected TCP sockets."""

    def __init__(self, network: Network = HOST_NETWORK) -> None:
        self._diag = network.open_diag()

    def close(self) -> None:
        """Ask no more."""
        if self._diag:
            self._diag.close()
            self._diag = None

    def untaken(self, sock: socket.socket) -> int | None:
        """Return how many bytes of what `sock` has sent are known to wait.

        None if the kernel cannot be asked now, or the socket is closed.
        """
        try:
            count = fcntl.ioctl(sock, termios.TIOCOUTQ, bytes(_COUNT.size))
            return int(_COUNT.unpack(count)[0]) + self._unread_here(sock)
        except (OSError, ValueError):  # ValueError: it has no descriptor any more
            return None

    def _unread_here(self, sock: socket.socket) -> int:
        """Return how many bytes the other end has not read, 0 if it is on another machine."""
        if self._diag is None:
            return 0
        with suppress(BlockingIOError):  # an answer that nobody waited for
            self._diag.recv(_MOST_ANSWER)
        self._diag.send(_request(sock))
        answer = self._diag.recv(_MOST_ANSWER)
        is_found = len(answer) >= _RECEIVE_QUEUE_AT + _COUNT.size and (
            _HEADER.unpack_from(answer)[1] == _SOCK_DIAG_BY_FAMILY
        )
        return int(_COUNT.unpack_from(answer, _RECEIVE_QUEUE_AT)[0]) if is_found else 0


def _request(sock: socket.socket) -> bytes:
    """Return the question for the other end of a connection."""
    family = sock.family
    (near, near_port), (far, far_port) = sock.getsockname()[:2], sock.getpeername()[:2]
    body = _REQUEST.pack(
        *(family, socket.IPPROTO_TCP, 0, 0, _ANY),
        *(far_port.to_bytes(2, "big"), near_port.to_bytes(2, "big")),
        *(socket.inet_pton(family, far), socket.inet_pton(family, near)),
        *(0, _ANY, _ANY),
    )
    size = _HEADER.size + len(body)
    return _HEADER.pack(size, _SOCK_DIAG_BY_FAMILY, _NLM_F_REQUEST, 0, 0) + body

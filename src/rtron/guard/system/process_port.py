"""Where two processes of a supervisor meet, whichever of the two begins again.

The supervisor makes the port and hands each of the two its side: nobody else can come in between.
"""

import select
import socket
from array import array

_MOST_BYTES = 64


class ProcessPort:
    """Both sides of the port; a process that has one of them takes it by its file descriptor."""

    def __init__(self) -> None:
        self.connecting_side, self.accepting_side = socket.socketpair(
            socket.AF_UNIX, socket.SOCK_SEQPACKET
        )

    def has_connection(self) -> bool:
        """Tell whether a connection waits for somebody to accept it."""
        waiting = select.poll()
        waiting.register(self.accepting_side, select.POLLIN)
        return bool(waiting.poll(0))


def connect(connecting_side: socket.socket, subject: bytes = b"-") -> socket.socket:
    """Return a connection about a `subject`, which the next one accepts if nobody runs.

    OSError if too many wait, or there are too many open files.
    """
    own, other = socket.socketpair()
    try:
        rights = (socket.SOL_SOCKET, socket.SCM_RIGHTS, array("i", [other.fileno()]))
        connecting_side.sendmsg([subject], [rights], socket.MSG_DONTWAIT)
    except BaseException:
        own.close()
        raise
    finally:
        other.close()
    return own


def accept(accepting_side: socket.socket) -> tuple[socket.socket, bytes] | None:
    """Return the connection that waits and what it is about, if there is one."""
    try:
        subject, files = receive_files(accepting_side, _MOST_BYTES, 1, socket.MSG_DONTWAIT)
    except BlockingIOError:
        return None
    return (socket.socket(fileno=files[0]), subject) if files else None


def receive_files(
    sock: socket.socket, most_bytes: int, most_files: int, flags: int = 0
) -> tuple[bytes, list[int]]:
    """Return a message and its files, which no program that this process starts gets.

    `socket.recv_fds` takes no flags in Python 3.11, and `send_fds` neither.
    """
    files = array("i")
    size = socket.CMSG_LEN(most_files * files.itemsize)
    data, ancillary, _, _ = sock.recvmsg(most_bytes, size, flags | socket.MSG_CMSG_CLOEXEC)
    for _, _, rights in ancillary:
        files.frombytes(rights[: len(rights) // files.itemsize * files.itemsize])
    return data, files.tolist()

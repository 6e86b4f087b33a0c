"""Where the bulk process and the recorder meet, whichever of the two begins again.

The supervisor makes the port and starts a recorder when somebody connects.
"""

import select
import socket
from contextlib import suppress

_MOST_BYTES = 1


class RecorderPort:
    """Both sides of the port; a process that has one of them takes it by its file descriptor."""

    def __init__(self) -> None:
        self.bulk_side, self.recorder_side = socket.socketpair(
            socket.AF_UNIX, socket.SOCK_SEQPACKET
        )

    def close(self) -> None:
        """Leave the port: a recorder that is there goes on."""
        self.bulk_side.close()
        self.recorder_side.close()

    def has_connection(self) -> bool:
        """Tell whether a connection waits for a recorder."""
        waiting = select.poll()
        waiting.register(self.recorder_side, select.POLLIN)
        return bool(waiting.poll(0))


def connect(bulk_side: socket.socket) -> socket.socket:
    """Return a connection to the recorder, which the next one takes if none runs.

    OSError if too many wait, or there are too many open files.
    """
    own, other = socket.socketpair()
    try:
        socket.send_fds(bulk_side, [bytes(_MOST_BYTES)], [other.fileno()], socket.MSG_DONTWAIT)
    except BaseException:
        own.close()
        raise
    finally:
        other.close()
    return own


def accept(recorder_side: socket.socket) -> socket.socket | None:
    """Return the connection that waits, if there is one."""
    files: list[int] = []
    with suppress(BlockingIOError):
        files = socket.recv_fds(recorder_side, _MOST_BYTES, 1, socket.MSG_DONTWAIT)[1]
    return socket.socket(fileno=files[0]) if files else None

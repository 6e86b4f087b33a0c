"""A driver that says when it is told to move, and when to rest: `python -m bench.cell.driver`.

Each line is `moves` or `rests`, and when the message came, ns of the system's steady clock.
"""

import selectors
import signal
import socket
import time
from contextlib import suppress

from bench.ros1.messages import MESSAGES
from bench.ros1.subscribers import Subscribers
from rtron.vocabulary import output_topic
from rtron.wire.ros1.network import master_uri

_LIMIT_S = 120
_TWIST = MESSAGES["twist"]
_PREFIX = 4
_AT_REST = bytes(48)


def main() -> None:
    """Listen until killed, two minutes at most."""
    signal.alarm(_LIMIT_S)
    selector = selectors.DefaultSelector()

    def connected(_topic: str, sock: socket.socket) -> None:
        selector.register(sock, selectors.EVENT_READ, bytearray())

    topics = [output_topic("/cmd_vel")]
    Subscribers(master_uri(), _TWIST, "/bench_sub", topics, connected, supervised=True)
    is_moving = False
    while True:
        for key, _ in selector.select(0.1):
            now = time.monotonic_ns()
            for frame in _read(selector, key.fileobj, key.data):  # type: ignore[arg-type]
                if (frame[_PREFIX:] != _AT_REST) != is_moving:
                    is_moving = not is_moving
                    print("moves" if is_moving else "rests", now, flush=True)


def _read(selector: selectors.BaseSelector, sock: socket.socket, buffer: bytearray) -> list[bytes]:
    data = b""
    with suppress(OSError):
        data = sock.recv(1 << 16)
    if not data:
        selector.unregister(sock)
        sock.close()
    buffer += data
    size = _PREFIX + len(_AT_REST)
    frames = [bytes(buffer[at : at + size]) for at in range(0, len(buffer) - size + 1, size)]
    del buffer[: len(frames) * size]
    return frames


if __name__ == "__main__":
    main()

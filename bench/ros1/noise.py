"""A publisher that is too fast with every second message: each one is an event of the guard.

`python -m bench.ros1.noise TOPIC RATE` publishes until it is ended.
"""

import os
import socket
import struct
import sys
import time

from bench.ros1.messages import MESSAGES
from bench.ros1.publishers import Publishers

NODE = "/noise"
_SPEEDS = (0.1, 1.0)


def main() -> None:
    """Publish."""
    topic, rate = sys.argv[1], float(sys.argv[2])
    publishers = Publishers(os.environ["ROS_MASTER_URI"], MESSAGES["twist"], {topic: NODE})
    frames = [struct.pack("<I6d", 48, speed, 0, 0, 0, 0, 0) for speed in _SPEEDS]
    due = time.monotonic()
    while True:
        for frame in frames:
            _send(publishers, topic, frame)
            due += 1 / rate
            time.sleep(max(0.0, due - time.monotonic()))


def _send(publishers: Publishers, topic: str, frame: bytes) -> None:
    """Send to whoever listens; a guard that was killed does not any more."""
    connections = publishers.connections[topic]
    for connection in [each for each in tuple(connections) if not _try_send(each, frame)]:
        connections.remove(connection)
        connection.close()


def _try_send(connection: socket.socket, frame: bytes) -> bool:
    try:
        connection.sendall(frame)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    main()

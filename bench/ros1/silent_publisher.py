"""The process that falls silent.

    python -m bench.ros1.silent_publisher --publish NODE=TOPIC --subscribe TOPIC

It moves the robot for a moment, says no more, and waits for the first stop message. The result is
a line of JSON, in ns: `late`, how long after the silence of the plan each stop message came, and
`slept`, by how much each sleep of the same length was too long.
"""

import argparse
import json
import select
import signal
import socket
import struct
import time

from bench.ros1.messages import MESSAGES
from bench.ros1.publishers import Publishers
from bench.ros1.subscribers import Subscribers
from rtron.wire.ros1.network import master_uri

_TWIST = MESSAGES["twist"]
_FRAME = struct.Struct("<I6d")
_SPEED = 0.25
_MESSAGES = 4
_PERIOD_S = 0.01
_PATIENCE_S = 5.0
_START_S = 30.0
_START_LIMIT_S = 60
_SECOND = 1_000_000_000


class SilentPublisher:
    """A publisher of velocities, and what the robot hears of them."""

    def __init__(self, node: str, topic: str, output: str, silent_after: int) -> None:
        self._topic = topic
        self._silent_after = silent_after
        self._back: socket.socket | None = None
        self._buffer = b""
        self._publishers = Publishers(master_uri(), _TWIST, {topic: node})
        self._subscribers = Subscribers(
            master_uri(), _TWIST, "/bench_sub", [output], self._connected
        )

    def warm_up(self) -> None:
        """Ask for no motion until an answer comes back."""
        deadline = time.monotonic() + _START_S
        while not self._receive(0.0)[1]:
            if time.monotonic() > deadline:
                raise TimeoutError("nothing comes back")
            self._publish(0.0)
            time.sleep(0.02)

    def sleep(self) -> int:
        """Sleep as long as the silence, and let the stop end; return how much too long, ns."""
        began = time.monotonic_ns()
        time.sleep(self._silent_after / _SECOND)
        slept = time.monotonic_ns() - began
        while self._receive(0.0)[1]:
            pass
        return slept - self._silent_after

    def fall_silent(self) -> int:
        """Move the robot, and return how late the first stop message comes after the silence."""
        for _ in range(_MESSAGES):
            time.sleep(_PERIOD_S)
            sent = self._publish(_SPEED)
        return self._first_stop_time() - sent - self._silent_after

    def close(self) -> None:
        """Take back the registrations."""
        self._publishers.close()
        self._subscribers.close()

    def _publish(self, speed: float) -> int:
        """Send a velocity; return the time just before, ns."""
        now = time.monotonic_ns()
        self._publishers.send(self._topic, _FRAME.pack(_TWIST.size, speed, 0, 0, 0, 0, 0))
        return now

    def _first_stop_time(self) -> int:
        """Return when the first stop message after the last velocity came, ns."""
        passed = 0
        while True:
            now, speeds = self._receive(_PATIENCE_S)
            if not speeds:
                raise TimeoutError("the robot is not stopped")
            for speed in speeds:
                if passed == _MESSAGES and speed != _SPEED:
                    return now
                passed += speed == _SPEED

    def _receive(self, patience: float) -> tuple[int, list[float]]:
        """Return when something came within `patience` (s), ns, and the speeds in it."""
        if self._back is None or not select.select([self._back], [], [], patience)[0]:
            return 0, []
        data = self._back.recv(1 << 16)
        now = time.monotonic_ns()
        if not data:
            raise ConnectionError("the way was closed")
        self._buffer += data
        complete = len(self._buffer) // _FRAME.size * _FRAME.size
        frames, self._buffer = self._buffer[:complete], self._buffer[complete:]
        return now, [values[1] for values in _FRAME.iter_unpack(frames)]

    def _connected(self, _topic: str, sock: socket.socket) -> None:
        self._back = sock


def main() -> None:
    """Fall silent as the arguments say."""
    args = _arguments()
    signal.alarm(_START_LIMIT_S + args.rounds)
    node, topic = args.publish.split("=")
    silence = SilentPublisher(node, topic, args.subscribe, args.silent_after)
    silence.warm_up()
    slept, late = [], []
    for _ in range(args.rounds):
        slept.append(silence.sleep())
        late.append(silence.fall_silent())
    silence.close()
    print(json.dumps({"late": late, "slept": slept}))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Fall silent, and wait for the stop.")
    parser.add_argument("--publish", required=True, metavar="NODE=TOPIC")
    parser.add_argument("--subscribe", required=True, metavar="TOPIC")
    parser.add_argument("--rounds", type=int, default=200, help="how often")
    parser.add_argument("--silent-after", type=int, required=True, metavar="NS")
    return parser.parse_args()


if __name__ == "__main__":
    main()

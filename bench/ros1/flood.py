"""The process that floods: `python -m bench.ros1.flood --publish NODE=TOPIC --subscribe TOPIC`.

It publishes and subscribes at once, and never has more than `window` messages on their way, so
that what stands between is as busy as it can be and nothing is lost for want of room. The result
is a line of JSON: `received`, `lost` and `seconds`.
"""

import argparse
import json
import select
import signal
import socket
import time
from threading import Event

from bench.ros1.messages import MESSAGES, PREFIX, WARM_UP, stamp
from bench.ros1.publishers import Publishers
from bench.ros1.subscribers import Subscribers
from rtron.wire.ros1.network import master_uri

_TWIST = MESSAGES["twist"]
_FRAME = _TWIST.size + PREFIX.size
_SILENCE_S = 1.0
_START_S = 30.0


class Flood:
    """One way, filled to the window."""

    def __init__(self, node: str, topic: str, output: str) -> None:
        self._topic = topic
        self._back: socket.socket | None = None
        self._open = Event()
        self._rest = 0
        self.received = self.lost = 0
        self._publishers = Publishers(master_uri(), _TWIST, {topic: node})
        self._subscribers = Subscribers(
            master_uri(), _TWIST, "/bench_sub", [output], self._connected
        )

    def warm_up(self) -> None:
        """Send until something comes back, then wait until all of it did."""
        frame = _TWIST.frame()
        stamp(frame, 0, WARM_UP)
        deadline = time.monotonic() + _START_S
        while not (self._back and self._receive(0.05)):
            if time.monotonic() > deadline:
                raise TimeoutError("nothing comes back")
            self._publishers.send(self._topic, frame)
            self._open.wait(0.02)
        while self._receive(_SILENCE_S):
            pass
        self.received = 0

    def run(self, count: int, window: int, seconds: float) -> None:
        """Send `count` messages, or what can be sent in that time."""
        burst = bytes(_TWIST.frame() * (window // 2))
        deadline = time.monotonic() + seconds
        sent = 0
        while sent < count and time.monotonic() < deadline:
            self._publishers.send(self._topic, burst)
            sent += window // 2
            self._drain(sent, window // 2)
        self._drain(sent, 0)

    def close(self) -> None:
        """Take back the registrations."""
        self._publishers.close()
        self._subscribers.close()

    def _drain(self, sent: int, leave: int) -> None:
        while sent - self.received - self.lost > leave:
            if not self._receive(_SILENCE_S):
                self.lost = sent - self.received

    def _receive(self, patience: float) -> int:
        """Receive what is there within `patience` (s); return the number of messages."""
        if self._back is None or not select.select([self._back], [], [], patience)[0]:
            return 0
        data = self._back.recv(1 << 16)
        if not data:
            raise ConnectionError("the way was closed")
        complete, self._rest = divmod(self._rest + len(data), _FRAME)
        self.received += complete
        return complete or 1

    def _connected(self, _topic: str, sock: socket.socket) -> None:
        self._back = sock
        self._open.set()


def main() -> None:
    """Flood as the arguments say."""
    args = _arguments()
    signal.alarm(args.limit + 60)
    node, topic = args.publish.split("=")
    flood = Flood(node, topic, args.subscribe)
    flood.warm_up()
    start = time.monotonic()
    flood.run(args.count, args.window, args.limit)
    seconds = time.monotonic() - start
    flood.close()
    print(json.dumps({"received": flood.received, "lost": flood.lost, "seconds": seconds}))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Publish and receive as fast as it goes.")
    parser.add_argument("--publish", required=True, metavar="NODE=TOPIC")
    parser.add_argument("--subscribe", required=True, metavar="TOPIC")
    parser.add_argument("--count", type=int, default=100_000, help="messages in all")
    parser.add_argument("--window", type=int, default=64, help="messages on their way at most")
    parser.add_argument("--limit", type=int, default=60, help="seconds after which to stop")
    return parser.parse_args()


if __name__ == "__main__":
    main()

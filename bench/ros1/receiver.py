"""The process that listens: `python -m bench.ros1.receiver --subscribe TOPIC ... --count N`.

It prints `ready` once every topic was heard, and at the end a line of JSON: `latencies_ns` and
`sequences` in the order of arrival, and `disordered`, how many came after a later one of their
publisher. The end is `count` messages, or a silence after the end of standard input.
"""

import json
import selectors
import signal
import socket
import sys
import time
from contextlib import suppress

from bench.common.arguments import to_listen
from bench.common.pubsub import LatencyRecorder
from bench.ros1.messages import MESSAGES, PREFIX, STAMP, WARM_UP
from bench.ros1.subscribers import Subscribers
from rtron.wire.ros1.network import master_uri

_SILENCE_S = 1.0
_ROOM = 1 << 16


class PublisherConnection:
    """One publisher's connection: its bytes stay where they were received."""

    def __init__(
        self, topic: str, sock: socket.socket, recorder: LatencyRecorder, room: int
    ) -> None:
        self._topic = topic
        self._sock = sock
        self._recorder = recorder
        self._buffer = bytearray(room)
        self._end = 0
        self._last = -1

    def read(self) -> bool:
        """Take what is there; False at the end of the connection."""
        received = self._sock.recv_into(memoryview(self._buffer)[self._end :])
        now = time.monotonic_ns()
        self._end += received
        at = 0
        while frame_end := self._frame_end(at):
            self._record(now, *STAMP.unpack_from(self._buffer, at + PREFIX.size))
            at = frame_end
        if at:
            self._buffer[: self._end - at] = self._buffer[at : self._end]
            self._end -= at
        return received > 0

    def _frame_end(self, at: int) -> int:
        """Return where the frame at `at` ends, 0 while it is not complete."""
        if self._end - at < PREFIX.size:
            return 0
        end: int = at + PREFIX.size + PREFIX.unpack_from(self._buffer, at)[0]
        return end if end <= self._end else 0

    def _record(self, now: int, sent: int, sequence: int) -> None:
        recorder = self._recorder
        if sequence == WARM_UP:
            recorder.warm(self._topic)
            return
        recorder.latencies.append(now - sent)
        recorder.sequences.append(sequence)
        recorder.disordered += sequence < self._last
        self._last = sequence


def main() -> None:
    """Subscribe as the arguments say."""
    args = to_listen(MESSAGES, ros=1)
    signal.alarm(args.limit)
    message = MESSAGES[args.message]
    recorder = LatencyRecorder(set(args.subscribe), args.count)
    selector = selectors.DefaultSelector()

    def connected(topic: str, sock: socket.socket) -> None:
        connection = PublisherConnection(topic, sock, recorder, message.size + _ROOM)
        selector.register(sock, selectors.EVENT_READ, connection)

    with suppress(PermissionError):  # /dev/null cannot be waited for
        selector.register(sys.stdin, selectors.EVENT_READ, None)
    subscribers = Subscribers(master_uri(), message, args.node, args.subscribe, connected)
    _listen(selector, recorder)
    subscribers.close()
    print(json.dumps(recorder.result()), flush=True)


def _listen(selector: selectors.BaseSelector, recorder: LatencyRecorder) -> None:
    patience = None
    while len(recorder.sequences) < recorder.count:
        ready = selector.select(patience)
        if not ready:
            return
        for key, _ in ready:
            if key.data is None:
                patience = _SILENCE_S
                selector.unregister(key.fileobj)
            elif not key.data.read():
                selector.unregister(key.fileobj)


if __name__ == "__main__":
    main()

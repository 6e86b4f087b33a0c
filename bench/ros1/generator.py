"""The process that sends: `python -m bench.ros1.generator --publish NODE=TOPIC ... --count N`.

It sends messages that warm the way up until a line (or the end) of standard input says go, then
`count` numbered ones, in turn over the topics, `burst` at a time, at `rate` a second in all. The
result is a line of JSON: `sent`, `seconds`, and `late_ms`, the longest it ran behind its schedule.
"""

import argparse
import json
import select
import signal
import sys
import time
from collections.abc import Sequence
from itertools import cycle

from bench.common.arguments import to_send
from bench.common.pubsub import wait_until
from bench.ros1.messages import MESSAGES, WARM_UP, stamp
from bench.ros1.publishers import Publishers
from rtron.wire.ros1.network import master_uri

_WARM_UP_S = 0.02
_SECOND = 1_000_000_000


def main() -> None:
    """Publish as the arguments say."""
    args = to_send(MESSAGES, ros=1)
    signal.alarm(args.limit)
    message = MESSAGES[args.message]
    nodes = dict(reversed(pair.split("=")) for pair in args.publish)
    publishers = Publishers(master_uri(), message, nodes)
    frame = message.frame()
    _warm_up(publishers, tuple(nodes), frame)
    result = _send(publishers, tuple(nodes), frame * args.burst, args)
    print(json.dumps(result), flush=True)
    sys.stdin.readline()
    publishers.close()


def _warm_up(publishers: Publishers, topics: Sequence[str], frame: bytearray) -> None:
    while not select.select([sys.stdin], [], [], _WARM_UP_S)[0]:
        for topic in topics:
            stamp(frame, time.monotonic_ns(), WARM_UP)
            publishers.send(topic, frame)
    sys.stdin.readline()


def _send(
    publishers: Publishers, topics: Sequence[str], frames: bytearray, args: argparse.Namespace
) -> dict[str, float]:
    size = len(frames) // args.burst
    period = _SECOND * args.burst // args.rate if args.rate else 0
    start = time.monotonic_ns()
    latest = 0
    bursts = zip(range(0, args.count, args.burst), cycle(topics), strict=False)
    for number, (first, topic) in enumerate(bursts):
        late = wait_until(start + number * period) if period else 0
        latest = max(latest, late)
        now = time.monotonic_ns()
        for index in range(args.burst):
            stamp(frames, now, first + index, index * size)
        publishers.send(topic, frames)
    seconds = (time.monotonic_ns() - start) / _SECOND
    bursts_sent = -(-args.count // args.burst)
    return {"sent": bursts_sent * args.burst, "seconds": seconds, "late_ms": latest / 1e6}


if __name__ == "__main__":
    main()

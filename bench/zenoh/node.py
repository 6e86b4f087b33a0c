"""The processes of a robot on Zenoh: a router, one that receives, one that sends.

    python -m bench.zenoh.node route CONFIG
    python -m bench.zenoh.node receive CONFIG KEY COUNT
    python -m bench.zenoh.node send CONFIG KEY COUNT RATE BYTES

The receiver prints the latencies, in ns, as JSON; the sender waits for it before it begins.
"""

import json
import signal
import sys
import threading
import time

import zenoh

_LIMIT_S = 60
_SILENCE_S = 2
_CLOCK_BYTES = 8


def main() -> None:
    """Run one of the three."""
    verb, config, *rest = sys.argv[1:]
    with zenoh.open(zenoh.Config.from_file(config)) as session:
        if verb == "route":
            _route()
        elif verb == "receive":
            print(json.dumps(_receive(session, rest[0], int(rest[1]))), flush=True)
        else:
            _send(session, rest[0], *map(int, rest[1:]))


def _route() -> None:
    end = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: end.set())
    while not end.wait(1):
        pass


def _receive(session: zenoh.Session, key: str, count: int) -> list[int]:
    """Return the latencies of `count` messages, or of fewer if the rest does not come."""
    latencies: list[int] = []
    end = threading.Event()

    def heard(sample: zenoh.Sample) -> None:
        now = time.monotonic_ns()
        latencies.append(now - int.from_bytes(bytes(sample.payload)[:_CLOCK_BYTES], "big"))
        if len(latencies) == count:
            end.set()

    subscriber = session.declare_subscriber(key, heard)
    limit, before = time.monotonic() + _LIMIT_S, -1
    while not end.wait(_SILENCE_S) and time.monotonic() < limit and len(latencies) != before:
        before = len(latencies) or -1
    subscriber.undeclare()
    return latencies


def _send(session: zenoh.Session, key: str, count: int, rate: int, size: int) -> None:
    publisher = session.declare_publisher(key)
    while not publisher.matching_status.matching:
        time.sleep(0.01)
    rest = bytes(size - _CLOCK_BYTES)
    started = time.monotonic()
    for number in range(count):
        time.sleep(max(0.0, started + number / rate - time.monotonic()))
        publisher.put(time.monotonic_ns().to_bytes(_CLOCK_BYTES, "big") + rest)
    time.sleep(0.5)


if __name__ == "__main__":
    main()

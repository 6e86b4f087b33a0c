"""Two clients with roslibpy, one that publishes and one that reads: `PORT TOKEN TOKEN COUNT`.

Prints how long each message took from one to the other, ns, as a line of JSON.
"""

import json
import sys
import threading
import time

import roslibpy

_TIMEOUT_S = 30.0
_PAUSE_S = 0.01
_WARM_UP = 20


def main() -> None:
    """Connect, wait until a message comes through, and measure."""
    port, sender, reader, count = sys.argv[1:]
    ends = [_connect(int(port), token) for token in (sender, reader)]
    came = threading.Semaphore(0)
    sent, latencies = {}, []

    def take(message: dict[str, str]) -> None:
        began = sent.pop(message["data"], None)
        if began is not None:
            latencies.append(time.monotonic_ns() - began)
            came.release()

    roslibpy.Topic(ends[1], "/chat", "std_msgs/String").subscribe(take)
    topic = roslibpy.Topic(ends[0], "/chat", "std_msgs/String")
    number, deadline = 0, time.monotonic() + _TIMEOUT_S
    while len(latencies) < _WARM_UP + int(count) and time.monotonic() < deadline:
        number += 1
        sent[str(number)] = time.monotonic_ns()
        topic.publish({"data": str(number)})
        came.acquire(timeout=0.5)
        time.sleep(_PAUSE_S)
    print(json.dumps(latencies[_WARM_UP:]), flush=True)
    ends[0].terminate()


def _connect(port: int, token: str) -> roslibpy.Ros:
    ros = roslibpy.Ros("127.0.0.1", port, headers={"Authorization": f"Bearer {token}"})
    ros.run(_TIMEOUT_S)
    return ros


if __name__ == "__main__":
    main()

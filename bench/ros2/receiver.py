"""The process that listens on ROS 2: `python -m bench.ros2.receiver --subscribe TOPIC ...`.

As `bench.ros1.receiver`. Every subscription wakes the process by an eventfd and is read without
conversions, so that what is measured is the way and not this end of it.
"""

import json
import signal
import sys
import threading
import time
from functools import partial

from bench.common.arguments import to_listen
from bench.common.pubsub import LatencyRecorder
from bench.ros2.endpoints import class_of, node, qos
from bench.ros2.messages import DEPTH, MESSAGES, WARM_UP, Message
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.rcl import EventFd, Rcl
from rtron.guard.transport.ros2.sender_ids import GraphSenderIds

_SILENCE_S = 1.0


def main() -> None:
    """Subscribe as the arguments say."""
    args = to_listen(MESSAGES, ros=2)
    signal.alarm(args.limit)
    message = MESSAGES[args.message]
    recorder = LatencyRecorder(set(args.subscribe), args.count)
    loop, rcl, receiver_node = EventLoop(), Rcl(GraphSenderIds()), node(args.node)
    for topic in args.subscribe:
        subscription = receiver_node.create_subscription(
            class_of(message.type), topic, print, qos(), raw=True
        )
        take = partial(rcl.take, subscription.handle.pointer)
        wake_up = EventFd(loop, partial(_read, loop, recorder, topic, message, take, {}))
        rcl.notify("subscription", subscription.handle, wake_up.fd)
    threading.Thread(target=_await_end, args=(loop, recorder), daemon=True).start()
    loop.run()
    print(json.dumps(recorder.result()), flush=True)


def _read(loop, recorder, topic: str, message: Message, take, last, count: int) -> None:  # noqa: ANN001
    for _ in range(min(count, DEPTH)):
        taken = take()
        if taken is None:
            return
        now = time.monotonic_ns()
        sent, number = message.read(taken[0])
        if number == WARM_UP:
            recorder.warm(topic)
            continue
        recorder.latencies.append(now - sent)
        recorder.sequences.append(number)
        recorder.disordered += number < last.get(topic, -1)
        last[topic] = number
        if len(recorder.sequences) >= recorder.count:
            loop.stop()


def _await_end(loop: EventLoop, recorder: LatencyRecorder) -> None:
    """Let the loop end when nothing has come for a while after the end of standard input."""
    sys.stdin.readline()

    def look(before: int) -> None:
        now = len(recorder.sequences)
        if now == before:
            loop.stop()
        else:
            loop.call_later(_SILENCE_S, lambda: look(now))

    loop.post(lambda: look(-1))


if __name__ == "__main__":
    main()

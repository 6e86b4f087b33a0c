"""A guard for ROS 2 without a supervisor: `python -m bench.ros2.guard_process STAGES`.

One stream, of one flow, through STAGES coordination nodes: more than a plan can have.
"""

import sys
from dataclasses import replace

from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER
from bench.common.unsupervised_guard import run_coordinator
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.middleware import Ros2Transport
from rtron.vocabulary import Plan, Stream, build_streams
from rtron.wire.ros2.session import Ros2Session


def stream(stages: int) -> Stream:
    """Return a stream that several GRCNs govern, each with a policy of its own."""
    node = grcn("/bench_0", [PUBLISHER], "geometry_msgs/msg/Twist")
    (planned,) = build_streams(Plan(app="bench", ros=2, grcn=(node,)))
    (first,) = planned.stages
    more = tuple(replace(first, id=f"{first.id}_{number}") for number in range(1, stages + 1))
    return replace(planned, stages=more)


def main() -> None:
    """Guard until told to end."""
    loop = EventLoop()
    transport = Ros2Transport(loop, Ros2Session())
    run_coordinator(Coordinator(transport, (stream(int(sys.argv[1])),)), transport, loop)


if __name__ == "__main__":
    main()

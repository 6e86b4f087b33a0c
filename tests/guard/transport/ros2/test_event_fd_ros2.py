"""News of ROS 2 at the loop: each is dealt with, also after one that fails."""

import os

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.event_fd import EventFd

pytestmark = pytest.mark.ros2


@pytest.mark.parametrize(("told", "calls"), [(1, [1]), (3, [3, 2, 1]), (65, [64, 64, 63])])
def test_what_is_left_behind_a_failure_is_taken(told, calls):
    loop, counts = EventLoop(), []

    def failing(count):
        counts.append(count)
        raise ValueError(count)

    bell = EventFd(loop, failing)
    os.eventfd_write(bell.fd, told)
    for _ in calls:
        loop.step(0.0)
    assert counts[: len(calls)] == calls
    loop.close()
    bell.close()

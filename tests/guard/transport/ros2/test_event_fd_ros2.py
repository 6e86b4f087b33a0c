"""News of ROS 2 at the loop: each is dealt with, also after one that fails."""

import os

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.rcl import EventFd

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


def test_what_is_left_for_later_is_taken_behind_the_other_events():
    loop, taken = EventLoop(), []
    bells = []
    for name in "ab":
        bells.append(
            EventFd(loop, lambda count, name=name: taken.append((name, count)) or count - 1)
        )
        os.eventfd_write(bells[-1].fd, 2)
    for _ in range(3):
        loop.step(0.0)
    assert sorted(taken[:2]) == [("a", 2), ("b", 2)]
    assert sorted(taken[2:]) == [("a", 1), ("b", 1)]
    loop.close()
    for bell in bells:
        bell.close()

"""Places in the domain of a test."""

from contextlib import ExitStack, closing

import pytest


@pytest.fixture
def stand(ros2, monkeypatch):
    """Give places in the test's domain, each a participant of its own."""
    from rclpy_nodes import RclpyParticipant  # noqa: PLC0415 - it needs rclpy

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with ExitStack() as stack:
        yield lambda: stack.enter_context(closing(RclpyParticipant(ros2.domain)))

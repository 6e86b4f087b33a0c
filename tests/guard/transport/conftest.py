"""The worlds that every test of the contract is run in."""

import pytest
from transport_worlds import InMemory, OnRos1

MEMORY = pytest.param("memory", id="memory")
ROS1 = pytest.param("ros1", id="ros1", marks=pytest.mark.ros1)
ROS2 = pytest.param(
    "ros2",
    id="ros2",
    marks=[pytest.mark.ros2, pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")],
)


@pytest.fixture(params=[MEMORY, ROS1, ROS2])
def world(request):
    """Have the guard's transport in each world, with nobody else in it."""
    with _world(request) as world:
        yield world


def _world(request):
    if request.param == "memory":
        return InMemory()
    if request.param == "ros1":
        return OnRos1(request.getfixturevalue("ros1"))
    pytest.importorskip("rclpy", reason="needs ROS 2")
    from ros2_world import OnRos2  # noqa: PLC0415 - it needs rclpy

    request.getfixturevalue("monkeypatch").setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    return OnRos2(request.getfixturevalue("ros2"))

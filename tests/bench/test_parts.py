"""The bench has its parts at hand, whether rclpy is installed or not."""

from pkgutil import resolve_name

import pytest

from bench.__main__ import PARTS, ROS2_PARTS


@pytest.mark.parametrize("part", PARTS.values())
def test_a_part_is_there(part: str) -> None:
    assert callable(resolve_name(f"bench.{part}"))


@pytest.mark.ros2
@pytest.mark.parametrize("part", ROS2_PARTS.values())
def test_a_part_for_ros_2_is_there(part: str) -> None:
    assert callable(resolve_name(f"bench.{part}"))

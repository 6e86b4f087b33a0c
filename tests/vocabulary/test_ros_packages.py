"""Which packages belong together."""

import pytest

from rtron.vocabulary.ros_packages import are_one_stack


@pytest.mark.parametrize(
    ("packages", "expected"),
    [
        (["nav2_controller", "opennav_docking"], True),
        (["move_base", "moveit_servo"], True),
        (["nav2_controller"], True),
        (["nav2_controller", "move_base"], False),
        (["nav2_controller", "my_nav2_node"], False),
        (["teleop_twist_joy"], False),
    ],
)
def test_packages_of_one_stack(packages, expected):
    assert are_one_stack(packages) is expected

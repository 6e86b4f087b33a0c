"""The cases of tests/vocabulary/test_remap_rules.py, put to a real rcl."""

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2")
pytestmark = pytest.mark.ros2

from remap_cases import CASES  # noqa: E402


@pytest.fixture(scope="module")
def context():
    context = rclpy.Context()
    rclpy.init(args=[], context=context)
    yield context
    rclpy.shutdown(context=context)


@pytest.mark.parametrize(("rules", "node", "name", "target"), CASES)
def test_rcl_resolves_it_so(context, rules, node, name, target):
    space, _, base = node.rpartition("/")
    arguments = [word for rule in rules for word in ("-r", ":=".join(rule))]
    made = rclpy.create_node(
        base,
        namespace=space,
        context=context,
        cli_args=["--ros-args", *arguments],
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
    )
    try:
        assert made.resolve_topic_name(name) == target
    finally:
        made.destroy_node()

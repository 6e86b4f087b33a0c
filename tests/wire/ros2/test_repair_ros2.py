"""How soon the guard's messages are known to have come, and lost ones are sent again."""

import sys

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
pytestmark = pytest.mark.ros2

SAYS = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.duration import Duration
from rtron.wire.ros2.discovery_tuning import configure_fast_dds
configure_fast_dds("rmw_fastrtps_cpp")
rclpy.init()
publisher = rclpy.create_node("speaker").create_publisher(Twist, "/cmd_vel", 10)
while not publisher.get_subscription_count():
    pass
for _ in range(4):
    publisher.publish(Twist())
    print("acknowledged", publisher.wait_for_all_acked(Duration(seconds=1)))
"""


def test_each_message_is_acknowledged_before_the_3_s_of_fast_dds(ros2):
    ros2.node("twist_subscriber.py", "/cmd_vel", name="/driver")
    speaker = ros2.spawn(sys.executable, "-c", SAYS)
    wait_for(lambda: speaker.ended, 60, what="the speaker")
    assert speaker.log.count("acknowledged True") == 4

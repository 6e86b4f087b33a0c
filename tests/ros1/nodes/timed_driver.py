#!/usr/bin/python3
"""A base of rospy: writes the time (ns of the steady clock) and angular.z of every message.

FILE is the only argument; the topic is /cmd_vel, remapped.
"""

import sys
import time
from pathlib import Path

import rospy
from geometry_msgs.msg import Twist


def main() -> None:
    """Listen until told to end."""
    rospy.init_node("base")
    with Path(rospy.myargv()[1]).open("a", buffering=1) as file:

        def heard(twist: Twist) -> None:
            file.write(f"{time.monotonic_ns()} {twist.angular.z:g}\n")

        rospy.Subscriber("/cmd_vel", Twist, heard, tcp_nodelay=True)
        rospy.spin()


if __name__ == "__main__":
    sys.exit(main())

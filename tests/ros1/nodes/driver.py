#!/usr/bin/python3
"""A wheel driver: appends linear.x and angular.z of every /cmd_vel, and who sent it, to a file."""

from contextlib import suppress

import rospy
from geometry_msgs.msg import Twist


def main():
    _, path = rospy.myargv()
    rospy.init_node("driver")
    with open(path, "a", buffering=1) as file:  # noqa: PTH123
        rospy.Subscriber("/cmd_vel", Twist, lambda told: file.write(line(told)), tcp_nodelay=True)
        rospy.spin()


def line(told):
    sender = told._connection_header["callerid"]
    return f"{told.linear.x:g} {told.angular.z:g} {sender}\n"


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

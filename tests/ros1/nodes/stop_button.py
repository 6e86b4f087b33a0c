#!/usr/bin/python3
"""A stop button: says whether a file is there, which somebody makes to press it."""

import os
from contextlib import suppress

import rospy
from std_msgs.msg import Bool


def main():
    _, path = rospy.myargv()
    rospy.init_node("stop_button")
    publisher = rospy.Publisher("/estop", Bool, queue_size=1)
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        publisher.publish(os.path.exists(path))  # noqa: PTH110
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

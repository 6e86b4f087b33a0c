#!/usr/bin/python3
"""Publishes a /cmd_vel with linear.x 0.25, ten times a second."""

from contextlib import suppress

import rospy
from geometry_msgs.msg import Twist, Vector3


def main():
    rospy.init_node("twist_publisher")
    topic = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
    rate = rospy.Rate(10)
    while not rospy.is_shutdown():
        topic.publish(Twist(linear=Vector3(x=0.25)))
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

#!/usr/bin/python3
"""Floods "turn right"; the rate in Hz is its argument."""

from contextlib import suppress

import rospy
from geometry_msgs.msg import Twist


def main():
    rospy.init_node("rogue")
    publisher = rospy.Publisher("/cmd_vel", Twist, queue_size=1000, tcp_nodelay=True)
    rate, message = rospy.Rate(float(rospy.myargv()[1])), Twist()
    message.angular.z = -0.2
    while not rospy.is_shutdown():
        publisher.publish(message)
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

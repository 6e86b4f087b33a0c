#!/usr/bin/python3
"""Navigates: counts up in mm/s of linear.x at 10 Hz, the first as soon as somebody is connected.

It turns left: no stop of a guard or a supervisor looks like a message of navigation. And it is
slow: from metres a second that it counted up to, every stop would be a ramp of many seconds.
"""

from contextlib import suppress

import rospy
from geometry_msgs.msg import Twist


def main():
    rospy.init_node("nav")
    publisher = rospy.Publisher("/cmd_vel", Twist, queue_size=100, tcp_nodelay=True)
    look = rospy.Rate(200)  # a listener of the publisher may come after its first subscriber
    while not publisher.get_num_connections() and not rospy.is_shutdown():
        look.sleep()
    rate, message, count = rospy.Rate(10), Twist(), 0
    message.angular.z = 0.5
    while not rospy.is_shutdown():
        message.linear.x = count / 1000
        publisher.publish(message)
        count += 1
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

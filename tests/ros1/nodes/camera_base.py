#!/usr/bin/python3
"""A robot that says in one order what it films (/image) and what it is told (/cmd_vel)."""

import rospy
from film import RATE, Film, say_speed
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Image


def main():
    rospy.init_node("robot")
    camera, picture = rospy.Publisher("/image", Image, queue_size=10), Image()

    def take():
        picture.header.stamp = rospy.Time.now()
        camera.publish(picture)

    rospy.Subscriber("/cmd_vel", Twist, say_speed)
    rospy.Timer(rospy.Duration(1 / RATE), Film(take).tick)
    rospy.spin()


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Publishes and subscribes what its arguments say: `>/topic` and `</topic`, of std_msgs/String."""

import rospy
from std_msgs.msg import String


def main():
    rospy.init_node("ends")
    for argument in rospy.myargv()[1:]:
        side, topic = argument[0], argument[1:]
        if side == ">":
            rospy.Publisher(topic, String, queue_size=1)
        else:
            rospy.Subscriber(topic, String, print)
    print("ready")
    rospy.spin()


if __name__ == "__main__":
    main()

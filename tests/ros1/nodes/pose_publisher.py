#!/usr/bin/python3
"""Gives poses on /act_simple/goal: their x is what each line of the file of its argument says."""

from contextlib import suppress

import rospy
from geometry_msgs.msg import PoseStamped
from raw_action import followed, wait_for_ends


def main():
    _, numbers = rospy.myargv()
    rospy.init_node("pose_giver")
    poses = rospy.Publisher("act_simple/goal", PoseStamped, queue_size=10)
    wait_for_ends(poses)
    for number in followed(numbers):
        pose = PoseStamped()
        pose.pose.position.x = number
        poses.publish(pose)


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

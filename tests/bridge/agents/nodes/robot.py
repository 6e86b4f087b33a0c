#!/usr/bin/python3
"""A robot without a body: obeys /cmd_vel, takes /goal, tells where it is, and notes all it hears.

The file has a JSON object a line: `at` (s since 1970), and `velocity` [x, y, yaw], `goal` [x, y]
or `chat`. A Pose2D on /place puts it somewhere else.
"""

import json
import math
import time
from contextlib import suppress

import rospy
from geometry_msgs.msg import Pose2D, PoseStamped, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import String

RATE = 20


class Robot:
    def __init__(self, file):
        self.file = file
        self.x = self.y = self.yaw = 0.0
        self.velocity = (0.0, 0.0, 0.0)
        self.odometry = rospy.Publisher("/odom", Odometry, queue_size=1)
        rospy.Subscriber("/cmd_vel", Twist, self.drive, tcp_nodelay=True)
        rospy.Subscriber("/goal", PoseStamped, self.go, tcp_nodelay=True)
        rospy.Subscriber("/chat", String, lambda told: self.note(chat=told.data))
        rospy.Subscriber("/place", Pose2D, self.place, tcp_nodelay=True)

    def note(self, **what):
        self.file.write(json.dumps({"at": time.time(), **what}) + "\n")

    def drive(self, told):
        self.velocity = (told.linear.x, told.linear.y, told.angular.z)
        self.note(velocity=self.velocity)

    def go(self, told):
        self.note(goal=[told.pose.position.x, told.pose.position.y])

    def place(self, told):
        self.x, self.y, self.yaw = told.x, told.y, told.theta

    def move(self, _event):
        ahead, _, turn = self.velocity
        self.x += ahead * math.cos(self.yaw) / RATE
        self.y += ahead * math.sin(self.yaw) / RATE
        self.yaw += turn / RATE
        message = Odometry()
        message.header.stamp, message.header.frame_id = rospy.Time.now(), "map"
        message.pose.pose.position.x, message.pose.pose.position.y = self.x, self.y
        message.pose.pose.orientation.w = 1.0
        self.odometry.publish(message)


def main():
    _, path = rospy.myargv()
    rospy.init_node("robot")
    with open(path, "a", buffering=1) as file:  # noqa: PTH123
        robot = Robot(file)
        rospy.Timer(rospy.Duration(1 / RATE), robot.move)
        rospy.spin()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

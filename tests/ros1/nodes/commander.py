#!/usr/bin/python3
"""A commander: drives at the speed that a file says last, and asks its lease for what it says.

The file grows line by line: `speed 0.5`, or `ask acquire to drive`. Answers are printed.
"""

from contextlib import suppress

import rospy
from geometry_msgs.msg import Twist
from std_msgs.msg import String


def main():
    path, *lease = rospy.myargv()[1:]
    rospy.init_node("commander")
    drive = rospy.Publisher("/cmd_vel", Twist, queue_size=10, tcp_nodelay=True)
    ask = None
    for name in lease:
        ask = rospy.Publisher(name + "/request", String, queue_size=10, tcp_nodelay=True)
        rospy.Subscriber(name + "/answer", String, lambda said: print("answer", said.data))
    rate, speed = rospy.Rate(50), None
    with open(path) as file:  # noqa: PTH123
        while not rospy.is_shutdown():
            speed = follow(file, ask, speed)
            if speed is not None:
                command = Twist()
                command.linear.x = speed
                drive.publish(command)
            rate.sleep()


def follow(file, ask, speed):
    """Do what the new lines of the file say, once the guard can hear it; return the speed."""
    for line in file if ask is None or ask.get_num_connections() else ():
        word, _, rest = line.strip().partition(" ")
        if word == "ask":
            ask.publish(rest)
        else:
            speed = float(rest)
    return speed


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

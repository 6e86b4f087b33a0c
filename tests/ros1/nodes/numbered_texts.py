#!/usr/bin/python3
"""Says COUNT numbered texts of BYTES on /burst, all at once, or tells the numbers that it hears.

Without arguments it hears. A publisher without a queue of its own loses nothing: it waits.
"""

import sys

import rospy
from std_msgs.msg import String


def hear():
    rospy.Subscriber(
        "/burst", String, lambda text: sys.stdout.write(f"part {text.data.split()[0]}\n")
    )


def say_all(count, size):
    publisher, look = rospy.Publisher("/burst", String, queue_size=None), rospy.Rate(50)
    while not publisher.get_num_connections():
        look.sleep()
    for number in range(count):
        publisher.publish(str(number).ljust(size))


def main():
    rospy.init_node("texts")
    arguments = [int(each) for each in rospy.myargv()[1:]]
    say_all(*arguments) if arguments else hear()
    rospy.spin()


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""A base with all that a cell may carry: what it does goes to the file of its argument.

It publishes /odom (Float64, counting) and a latched /state, and /unlisted; it subscribes /lamp and
/unlisted_in, serves /reset, and calls /map_of at the start.
"""

import sys
from contextlib import suppress
from pathlib import Path

import rospy
from roscpp.msg import Logger
from roscpp.srv import GetLoggers, GetLoggersResponse
from std_msgs.msg import Float64, String


def main():
    path = rospy.myargv()[1]

    def write(*words):
        with Path(path).open("a") as file:
            print(*words, file=file, flush=True)

    rospy.init_node("base")
    odom = rospy.Publisher("/odom", Float64, queue_size=10)
    state = rospy.Publisher("/state", Float64, queue_size=1, latch=True)
    unlisted = rospy.Publisher("/unlisted", Float64, queue_size=1)
    rospy.Subscriber("/lamp", String, lambda message: write("lamp", message.data))
    rospy.Subscriber("/unlisted_in", String, lambda message: write("unlisted_in", message.data))

    def reset(_request):
        write("reset")
        return GetLoggersResponse([Logger("was reset", "")])

    rospy.Service("/reset", GetLoggers, reset)
    state.publish(7)
    write("wheel", rospy.get_param("~wheel", "none"), "other", rospy.get_param("/other", "none"))
    rospy.wait_for_service("/map_of", timeout=30)
    write("map", rospy.ServiceProxy("/map_of", GetLoggers)().loggers[0].name)
    rate, number = rospy.Rate(20), 0
    while not rospy.is_shutdown():
        odom.publish(number)
        unlisted.publish(number)
        number += 1
        write("param", rospy.get_param("~wheel", "none"))
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()
    sys.exit(0)

#!/usr/bin/python3
"""Serves a roscpp/GetLoggers: its arguments are the service and what it answers."""

import rospy
from roscpp.msg import Logger
from roscpp.srv import GetLoggers, GetLoggersResponse


def main():
    rospy.init_node("server")
    service, answer = rospy.myargv()[1:]
    rospy.Service(service, GetLoggers, lambda _: GetLoggersResponse([Logger(answer, "")]))
    rospy.spin()


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Calls a roscpp/GetLoggers, its argument, once, and prints the answer or the error."""

import rospy
from roscpp.srv import GetLoggers


def main():
    rospy.init_node("client")
    (service,) = rospy.myargv()[1:]
    rospy.wait_for_service(service, timeout=30)
    try:
        print("answer:", rospy.ServiceProxy(service, GetLoggers)().loggers[0].name, flush=True)
    except rospy.ServiceException as error:
        print("error:", error, flush=True)


if __name__ == "__main__":
    main()

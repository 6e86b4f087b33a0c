#!/usr/bin/python3
"""Publishes a latched map, once."""

import rospy
from nav_msgs.msg import OccupancyGrid


def main():
    rospy.init_node("map_server")
    publisher = rospy.Publisher("/map", OccupancyGrid, latch=True, queue_size=1)
    message = OccupancyGrid()
    message.info.width, message.info.height = 3, 2
    message.data = [0, 100, -1, 0, 100, -1]
    publisher.publish(message)
    rospy.spin()


if __name__ == "__main__":
    main()

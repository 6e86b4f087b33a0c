"""A base of rospy: `base.py FILE LIMITS` on /cmd_vel, remapped.

FILE gets the time (ns of the steady clock) and angular.z of every message, LIMITS the value of the
parameter ~limit whenever it has changed.
"""

import sys
import time
from pathlib import Path

import rospy
from geometry_msgs.msg import Twist

_LOOK_S = 0.1


def main() -> None:
    """Listen until told to end."""
    rospy.init_node("base")
    told, limits = map(Path, rospy.myargv()[1:])
    with told.open("a", buffering=1) as file:

        def heard(twist: Twist) -> None:
            file.write(f"{time.monotonic_ns()} {twist.angular.z:g}\n")

        rospy.Subscriber("/cmd_vel", Twist, heard, tcp_nodelay=True)
        _watch(limits)


def _watch(limits: Path) -> None:
    """Write the limit down until told to end."""
    before = rospy.get_param("~limit", "")
    while not rospy.is_shutdown():
        if (now := rospy.get_param("~limit", "")) != before:
            limits.write_text(str(now))
            before = now
        time.sleep(_LOOK_S)


if __name__ == "__main__":
    sys.exit(main())

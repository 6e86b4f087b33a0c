#!/usr/bin/python3
"""Serves /act as move_base does: it drives while it has a goal, and takes poses as goals, too.

Arguments: the file for what it does, and a file without which no cancelled goal ends. A goal's
number says how long it drives, in ms, at 1 m/s for the first, 2 m/s for the second. A pose on
/act_simple/goal becomes a goal that it gives itself on /act/goal; the number is the pose's x.
"""

import os
import time
from contextlib import suppress

import actionlib
import rospy
from action_server import Log
from actionlib.msg import TestAction, TestActionGoal, TestGoal
from geometry_msgs.msg import PoseStamped, Twist

TICK_S = 0.02


class Base:
    """Drives to its goals."""

    def __init__(self, log, may_end):
        self._log, self._may_end = log, may_end
        self._speed = 0
        self._velocities = rospy.Publisher("cmd_vel", Twist, queue_size=10)
        self._own = rospy.Publisher("act/goal", TestActionGoal, queue_size=10)
        self._server = actionlib.SimpleActionServer(
            "act", TestAction, self._drive, auto_start=False
        )
        self._server.start()
        rospy.Subscriber("act_simple/goal", PoseStamped, self._take)

    def _take(self, pose):
        self._own.publish(TestActionGoal(goal=TestGoal(int(pose.pose.position.x))))

    def _drive(self, goal):
        goal_id = self._server.current_goal.get_goal_id().id
        self._log.say("started", goal_id, goal.goal)
        self._speed += 1
        end = time.monotonic() + goal.goal / 1000
        while time.monotonic() < end and not self._cancelled() and not rospy.is_shutdown():
            self._move()
        cancelled = self._server.is_preempt_requested()
        self._log.say("cancelled" if cancelled else "done", goal_id, goal.goal)
        if cancelled:
            self._server.set_preempted()
        else:
            self._server.set_succeeded()

    def _move(self):
        velocity = Twist()
        velocity.linear.x = self._speed
        self._velocities.publish(velocity)
        rospy.rostime.wallsleep(TICK_S)

    def _cancelled(self):
        return self._server.is_preempt_requested() and os.path.exists(self._may_end)  # noqa: PTH110


def main():
    _, path, may_end = rospy.myargv()
    rospy.init_node("base_server")
    log = Log(path)
    log.say("starting")
    Base(log, may_end)
    rospy.spin()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

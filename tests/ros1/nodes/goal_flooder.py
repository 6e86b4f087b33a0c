#!/usr/bin/python3
"""Floods /act with goals and cancels of every bad kind; its rate in Hz is the argument.

It listens to /act/status and uses the ids of others. All of its goals have the number FOREIGN.
"""

from contextlib import suppress
from itertools import count, takewhile

import rospy
from actionlib.msg import TestActionGoal
from actionlib_msgs.msg import GoalID, GoalStatusArray

FOREIGN = 7
HUGE = "x" * 20_000
FRESH = 5


class Stranger:
    """Sends goals and cancels in turn."""

    def __init__(self):
        self._goals = rospy.Publisher("act/goal", TestActionGoal, queue_size=1000)
        self._cancels = rospy.Publisher("act/cancel", GoalID, queue_size=1000)
        self._others = []
        rospy.Subscriber("act/status", GoalStatusArray, self._hear, queue_size=1)
        turns = (self._goal, self._cancel_all, self._goal_of_others, self._cancel_others)
        self._turns = (*turns, self._cancel_before_now)
        self._ids = ("", "{n}", "twice", HUGE, "a b\n\x00")

    def speak(self, n):
        self._turns[n % len(self._turns)](n)

    def _hear(self, array):
        self._others = [status.goal_id.id for status in array.status_list][-FRESH:]

    def _goal(self, n):
        self._send(self._ids[n // len(self._turns) % len(self._ids)].format(n=n))

    def _goal_of_others(self, n):
        for other in self._others[n % FRESH :][:1]:
            self._send(other)

    def _send(self, goal_id):
        goal = TestActionGoal(goal_id=GoalID(rospy.Time.now(), goal_id))
        goal.goal.goal = FOREIGN
        self._goals.publish(goal)

    def _cancel_all(self, n):
        self._cancels.publish(GoalID())

    def _cancel_others(self, n):
        for other in self._others[n % FRESH :][:1]:
            self._cancels.publish(GoalID(id=other))

    def _cancel_before_now(self, n):
        self._cancels.publish(GoalID(stamp=rospy.Time.now()))


def main():
    rospy.init_node("goal_stranger")
    stranger, rate = Stranger(), rospy.Rate(float(rospy.myargv()[1]))
    for n in takewhile(lambda _: not rospy.is_shutdown(), count()):
        stranger.speak(n)
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSException):
        main()

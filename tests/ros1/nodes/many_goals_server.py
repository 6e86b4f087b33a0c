#!/usr/bin/python3
"""Serves /act at once, and tells of as many goals of others, in a state, as its arguments say."""

from contextlib import suppress

import rospy
from actionlib.msg import TestActionFeedback, TestActionGoal, TestActionResult
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray

RATE_HZ = 2


def main():
    rospy.init_node("giant_server")
    count, state = map(int, rospy.myargv()[1:])
    statuses = rospy.Publisher("act/status", GoalStatusArray, latch=True, queue_size=1)
    results = rospy.Publisher("act/result", TestActionResult, queue_size=50)
    rospy.Publisher("act/feedback", TestActionFeedback, queue_size=1)

    def answer(goal):
        status = GoalStatus(goal_id=goal.goal_id, status=GoalStatus.SUCCEEDED)
        result = TestActionResult(status=status)
        result.result.result = goal.goal.goal
        results.publish(result)

    rospy.Subscriber("act/goal", TestActionGoal, answer)
    rospy.Subscriber("act/cancel", GoalID, lambda cancel: None)
    foreign = [GoalStatus(GoalID(id=f"/other-{n}-1.0"), state, "") for n in range(count)]
    rate = rospy.Rate(RATE_HZ)
    while not rospy.is_shutdown():
        statuses.publish(GoalStatusArray(status_list=foreign))
        rate.sleep()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

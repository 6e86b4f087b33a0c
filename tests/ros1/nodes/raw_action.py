#!/usr/bin/python3
"""Speaks /act's topics by hand: publishes what a file's lines of JSON say, writes what it hears.

Arguments: the file for what it hears, and the file to follow. A line has an `id`, and a goal's
number as `value`; one without cancels.
"""

import json
import time
from contextlib import suppress

import rospy
from actionlib.msg import TestActionFeedback, TestActionGoal, TestActionResult
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray

POLL_S = 0.005


def main():
    _, path, commands = rospy.myargv()
    rospy.init_node("raw_action")
    heard = open(path, "a", buffering=1)  # noqa: PTH123, SIM115 - kept open
    goals = rospy.Publisher("act/goal", TestActionGoal, queue_size=100)
    cancels = rospy.Publisher("act/cancel", GoalID, queue_size=100)

    def say(what, status, **more):
        row = {"what": what, "id": status.goal_id.id, "status": status.status, "text": status.text}
        row["time"] = time.monotonic_ns()
        heard.write(json.dumps(row | more) + "\n")

    def result(message):
        say("result", message.status, value=message.result.result)

    def feedback(message):
        say("feedback", message.status, value=message.feedback.feedback)

    def array(message):
        for status in message.status_list:
            say("status", status)

    rospy.Subscriber("act/result", TestActionResult, result)
    rospy.Subscriber("act/feedback", TestActionFeedback, feedback)
    rospy.Subscriber("act/status", GoalStatusArray, array)
    wait_for_ends(goals, cancels)
    say("ready", GoalStatus())
    for command in followed(commands):
        goal_id = GoalID(rospy.Time(command.get("stamp", 0)), command["id"])
        if "value" in command:
            goal = TestActionGoal(goal_id=goal_id)
            goal.goal.goal = command["value"]
            goals.publish(goal)
        else:
            cancels.publish(goal_id)


def wait_for_ends(*publishers):
    """Wait until somebody listens to each."""
    while not all(each.get_num_connections() for each in publishers) and not rospy.is_shutdown():
        time.sleep(POLL_S)


def followed(path):
    """Yield a file's lines of JSON as they are written."""
    with open(path) as file:  # noqa: PTH123
        line = ""
        while not rospy.is_shutdown():
            line += file.readline()
            if line.endswith("\n"):
                yield json.loads(line)
                line = ""
            else:
                time.sleep(POLL_S)


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

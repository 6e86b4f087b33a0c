#!/usr/bin/python3
"""A client of /act: does what a file of commands says, and writes what becomes of its goals.

Arguments: the file for what happens, the file of commands, and `simple` (a SimpleActionClient, one
goal at a time) or `many` (an ActionClient). It waits for the server, then follows the commands:
`goal VALUE`, `cancel NUMBER` (goals count from 1), `cancel_all`, and `wait NUMBER` until so many
goals are open.
"""

import threading
import time
from contextlib import suppress

import actionlib
import rospy
from actionlib.msg import TestAction, TestActionResult, TestGoal
from actionlib_msgs.msg import GoalStatus

POLL_S = 0.005


class Log:
    """Writes what happens, a line each behind the steady clock's ns, and counts the open goals."""

    def __init__(self, path):
        self._file = open(path, "a", buffering=1)  # noqa: PTH123, SIM115 - kept open
        self._changed = threading.Condition()
        self._open, self._ended = 0, set()

    def say(self, *words):
        line = " ".join(map(str, (time.monotonic_ns(), *words))) + "\n"
        with self._changed:
            self._file.write(line)

    def sent(self, number, value):
        self.say("sent", number, value)
        with self._changed:
            self._open += 1

    def done(self, number, status, result, text):
        value = "-" if result is None else result.result
        self.say("done", number, GoalStatus.to_string(status), value, text)
        with self._changed:
            self._ended.add(number)
            self._open -= 1
            self._changed.notify_all()

    def wait(self, count):
        with self._changed:
            while self._open > count and not rospy.is_shutdown():
                self._changed.wait(0.1)

    def take_ended(self):
        with self._changed:
            ended, self._ended = self._ended, set()
        return ended


class Simple:
    """Sends with a SimpleActionClient."""

    def __init__(self, log):
        self._log = log
        self._client = actionlib.SimpleActionClient("act", TestAction)
        self.wait_for_server = self._client.wait_for_server
        self.cancel_all = self._client.cancel_all_goals

    def send(self, number, goal):
        self._client.send_goal(
            goal,
            lambda status, result: self._log.done(
                number, status, result, self._client.get_goal_status_text()
            ),
            lambda: self._log.say("state", number, "ACTIVE"),
            lambda feedback: self._log.say("feedback", number, feedback.feedback),
        )

    def cancel(self, _):
        self._client.cancel_goal()


class Many:
    """Sends with an ActionClient."""

    def __init__(self, log):
        self._log, self._handles = log, {}
        self._client = actionlib.ActionClient("act", TestAction)
        self.wait_for_server = self._client.wait_for_server
        self.cancel_all = self._client.cancel_all_goals

    def send(self, number, goal):
        for ended in self._log.take_ended():
            del self._handles[ended]
        self._handles[number] = self._client.send_goal(
            goal,
            lambda handle: self._moved(number, handle),
            lambda _, feedback: self._log.say("feedback", number, feedback.feedback),
        )

    def cancel(self, number):
        self._handles[number].cancel()

    def _moved(self, number, handle):
        state = handle.get_comm_state()
        self._log.say("state", number, actionlib.CommState.to_string(state))
        if state == actionlib.CommState.DONE:
            text = handle.get_goal_status_text()
            self._log.done(number, handle.get_terminal_state(), handle.get_result(), text)


def lines(path):
    """Yield the lines of a file as they are written."""
    with open(path) as file:  # noqa: PTH123
        line = ""
        while not rospy.is_shutdown():
            line += file.readline()
            if line.endswith("\n"):
                yield line
                line = ""
            else:
                time.sleep(POLL_S)


def follow(path, client, log):
    sent = 0
    for line in lines(path):
        what, *numbers = line.split()
        if what == "goal":
            sent += 1
            log.sent(sent, *numbers)
            client.send(sent, TestGoal(int(*numbers)))
        elif what == "wait":
            log.wait(int(*numbers))
        else:
            getattr(client, what)(*map(int, numbers))


def main():
    _, path, commands, kind = rospy.myargv()
    rospy.init_node("action_client")
    log, own = Log(path), rospy.get_name() + "-"
    client = {"simple": Simple, "many": Many}[kind](log)

    def keep(message):
        status = message.status
        if status.goal_id.id.startswith(own):
            what = (status.goal_id.id, status.status, message.result.result, status.text)
            log.say("result", *what)

    rospy.Subscriber("act/result", TestActionResult, keep)
    client.wait_for_server()
    log.say("connected")
    follow(commands, client, log)


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

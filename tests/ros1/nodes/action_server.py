#!/usr/bin/python3
"""Serves /act as move_base would: a goal's number says how long it works, in ms, and how it ends.

Arguments: the file for what it does, then `simple` (a new goal preempts) or `queue` (goals wait).
A negative number aborts; NEVER is not answered at all, whatever is asked.
"""

import threading
import time
from contextlib import suppress
from urllib.parse import quote

import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestResult

NEVER = 1_000_000_000
TICK_MS = 10
SHOWN = 100


class Log:
    """Writes what happens, a line each, behind the steady clock's ns."""

    def __init__(self, path):
        self._file = open(path, "a", buffering=1)  # noqa: PTH123, SIM115 - kept open

    def say(self, what, goal_id="", *words):
        said = (time.monotonic_ns(), what, quote(goal_id[:SHOWN]), *words)
        self._file.write(" ".join(map(str, said)) + "\n")


class Work:
    """One goal's work in steps, with feedback, until it is done or cancelled."""

    def __init__(self, value, feedback, cancelled):
        self.value, self._feedback, self._cancelled = value, feedback, cancelled
        self.steps = 0

    def run(self):
        """Work; tell how it ended: `done`, `aborted` or `cancelled`."""
        self._step()
        end = time.monotonic() + abs(self.value) / 1000
        while (left := end - time.monotonic()) > 0 and not rospy.is_shutdown():
            if self.value != NEVER and self._cancelled():
                return "cancelled"
            rospy.rostime.wallsleep(min(left, TICK_MS / 1000))
            if left > TICK_MS / 1000:
                self._step()
        return "aborted" if self.value < 0 else "done"

    def _step(self):
        self._feedback(TestFeedback(self.steps))
        self.steps += 1


class Simple:
    """A SimpleActionServer, as most are."""

    def __init__(self, log):
        self._log = log
        self._server = actionlib.SimpleActionServer(
            "act", TestAction, self._execute, auto_start=False
        )
        self._server.start()

    def _execute(self, goal):
        goal_id = self._server.current_goal.get_goal_id().id
        self._log.say("started", goal_id, goal.goal)
        feedback, cancelled = self._server.publish_feedback, self._server.is_preempt_requested
        end = Work(goal.goal, feedback, cancelled).run()
        self._log.say(end, goal_id, goal.goal)
        ends = {
            "done": self._server.set_succeeded,
            "aborted": self._server.set_aborted,
            "cancelled": self._server.set_preempted,
        }
        ends[end](TestResult(goal.goal), end)


class Queue:
    """An ActionServer that takes every goal and works on one after the other."""

    def __init__(self, log):
        self._log = log
        self._waiting, self._cancelled = [], set()
        self._changed = threading.Condition()
        self._server = actionlib.ActionServer(
            "act", TestAction, self._take, self._cancel, auto_start=False
        )
        threading.Thread(target=self._serve, daemon=True).start()
        self._server.start()

    def _take(self, handle):
        self._log.say("taken", handle.get_goal_id().id, handle.get_goal().goal)
        with self._changed:
            self._waiting.append(handle)
            self._changed.notify()

    def _cancel(self, handle):
        self._cancelled.add(handle.get_goal_id().id)

    def _serve(self):
        while not rospy.is_shutdown():
            with self._changed:
                self._changed.wait_for(lambda: self._waiting)
                handle = self._waiting.pop(0)
            self._execute(handle)

    def _execute(self, handle):
        goal_id, value = handle.get_goal_id().id, handle.get_goal().goal
        if goal_id in self._cancelled:
            handle.set_canceled(TestResult(value), "recalled")
            return
        handle.set_accepted("accepted")
        self._log.say("started", goal_id, value)
        end = Work(value, handle.publish_feedback, lambda: goal_id in self._cancelled).run()
        self._log.say(end, goal_id, value)
        ends = {
            "done": handle.set_succeeded,
            "aborted": handle.set_aborted,
            "cancelled": handle.set_canceled,
        }
        ends[end](TestResult(value), end)


def main():
    _, path, kind = rospy.myargv()
    rospy.init_node("action_server")
    servers = {"simple": Simple, "queue": Queue}
    log = Log(path)
    log.say("starting")
    servers[kind](log)
    rospy.spin()


if __name__ == "__main__":
    with suppress(rospy.ROSInterruptException):
        main()

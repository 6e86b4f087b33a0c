"""A node of the soaked app on rospy, with the verbs of `ros2_graph.py`; nothing of RTron."""

# ruff: noqa: ANN401 - the messages of two ROS have no type in common

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import actionlib
import rospy
from actionlib.msg import TestAction, TestActionGoal, TestGoal, TestResult
from actionlib_msgs.msg import GoalID

from bench.soak.names import DOCK, FORBIDDEN_GOAL

if TYPE_CHECKING:
    from collections.abc import Callable

_QUEUE = 10
_BUFFER = 1 << 25
_STATES = {2: "canceled", 3: "succeeded", 4: "aborted", 5: "rejected", 8: "recalled"}


class Graph:
    """A node."""

    def __init__(self, name: str) -> None:
        rospy.init_node(name)

    def publish(
        self, topic: str, message: Any, rate: float, sent: Callable[[], object] = bool
    ) -> None:
        """Publish a message again and again, `rate` times a second; call `sent` each time."""
        publisher = rospy.Publisher(topic, type(message), queue_size=_QUEUE, tcp_nodelay=True)

        def publish(_: Any) -> None:
            publisher.publish(message)
            sent()

        rospy.Timer(rospy.Duration(1 / rate), publish)

    def listen(self, topic: str, kind: Any, handler: Callable[[Any], object]) -> None:
        """Call `handler` with each message."""
        rospy.Subscriber(topic, kind, handler, tcp_nodelay=True, buff_size=_BUFFER)

    def serve(self, work: Callable[[int, Callable[[], bool]], bool]) -> None:
        """Serve the action; `work` returns whether the goal was done, or ended by a cancel."""

        def execute(goal: Any) -> None:
            is_done = work(goal.goal, server.is_preempt_requested)
            (server.set_succeeded if is_done else server.set_preempted)(TestResult(goal.goal))

        server = actionlib.SimpleActionServer(DOCK, TestAction, execute, auto_start=False)
        server.start()

    def client(self) -> Client:
        """Return a client of the action."""
        return Client()

    def forge_goals(self, rate: float) -> None:
        """Send goals, and cancels of all goals, to the planner's private topics."""
        goal = TestActionGoal()
        goal.goal.goal = FORBIDDEN_GOAL
        self.publish(f"/rtron{DOCK}/goal/flow1", goal, rate)
        self.publish(f"/rtron{DOCK}/cancel/flow1", GoalID(), rate)

    def spin(self) -> None:
        """Run until the process is told to end."""
        rospy.spin()


class Client:
    """Sends one goal after the other."""

    def __init__(self) -> None:
        self._client = actionlib.SimpleActionClient(DOCK, TestAction)

    def wait_for_server(self) -> None:
        """Wait until there is a server, or a guard for one."""
        self._client.wait_for_server()

    def send(self, goal: int, accepted: Callable[[], None]) -> Client:
        """Send a goal; call `accepted` when its server works on it."""
        self._client.send_goal(TestGoal(goal), active_cb=accepted)
        return self

    def cancel(self) -> None:
        """Cancel the goal."""
        self._client.cancel_goal()

    def wait(self, limit_s: float) -> str:
        """Return how the goal ended, "" if it has not."""
        if not self._client.wait_for_result(rospy.Duration(limit_s)):
            return ""
        state = self._client.get_state()
        return _STATES.get(state, str(state))

"""A node of the soaked app on rclpy, with the verbs of `ros1_graph.py`; nothing of RTron."""

# ruff: noqa: ANN401 - the messages of two ROS have no type in common

from __future__ import annotations

from contextlib import suppress
from threading import Event
from typing import TYPE_CHECKING, Any

import rclpy
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from test_msgs.action import Fibonacci

from bench.soak.names import DOCK, FORBIDDEN_GOAL

if TYPE_CHECKING:
    from collections.abc import Callable

_QUEUE = 10
_THREADS = 4
_STATES = {4: "succeeded", 5: "canceled", 6: "aborted"}


class Graph:
    """A node."""

    def __init__(self, name: str) -> None:
        rclpy.init()
        self._node = rclpy.create_node(name)
        self._executor: MultiThreadedExecutor | None = None

    def publish(
        self, topic: str, message: Any, rate: float, sent: Callable[[], object] = bool
    ) -> None:
        """Publish a message again and again, `rate` times a second; call `sent` each time."""
        publisher = self._node.create_publisher(type(message), topic, _QUEUE)

        def publish() -> None:
            publisher.publish(message)
            sent()

        self._node.create_timer(1 / rate, publish)

    def listen(self, topic: str, kind: Any, handler: Callable[[Any], object]) -> None:
        """Call `handler` with each message."""
        self._node.create_subscription(kind, topic, handler, _QUEUE)

    def serve(self, work: Callable[[int, Callable[[], bool]], bool]) -> None:
        """Serve the action; `work` returns whether the goal was done, or ended by a cancel."""

        def execute(goal: Any) -> Fibonacci.Result:
            is_done = work(goal.request.order, lambda: goal.is_cancel_requested)
            (goal.succeed if is_done else goal.canceled)()
            return Fibonacci.Result()

        self._executor = MultiThreadedExecutor(_THREADS)
        self._server = ActionServer(
            self._node,
            Fibonacci,
            DOCK,
            execute,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )

    def client(self) -> Client:
        """Return a client of the action."""
        return Client(self._node)

    def forge_goals(self, rate: float) -> None:
        """Send goals, and cancels of all goals, under the planner's private names."""
        name = f"/rtron{DOCK}/flow1"
        goals = ActionClient(self._node, Fibonacci, name)
        cancels = self._node.create_client(CancelGoal, f"{name}/_action/cancel_goal")

        def forge() -> None:
            goals.send_goal_async(Fibonacci.Goal(order=FORBIDDEN_GOAL))
            cancels.call_async(CancelGoal.Request())

        self._node.create_timer(1 / rate, forge)

    def spin(self) -> None:
        """Run until the process is told to end."""
        with suppress(KeyboardInterrupt, ExternalShutdownException):
            rclpy.spin(self._node, self._executor)


class Client:
    """Sends goals; the node is spun elsewhere."""

    def __init__(self, node: Any) -> None:
        self._client = ActionClient(node, Fibonacci, DOCK)

    def wait_for_server(self) -> None:
        """Wait until there is a server, or a guard for one."""
        self._client.wait_for_server()

    def send(self, goal: int, accepted: Callable[[], None]) -> Goal:
        """Send a goal; call `accepted` when the goal was taken."""
        return Goal(self._client.send_goal_async(Fibonacci.Goal(order=goal)), accepted)


class Goal:
    """A goal that was sent."""

    def __init__(self, answer: Any, accepted: Callable[[], None]) -> None:
        self._accepted, self._handle = accepted, None
        self._state, self._ended = "", Event()
        answer.add_done_callback(lambda done: self._on_answer(done.result()))

    def cancel(self) -> None:
        """Cancel the goal, if it was taken."""
        if self._handle:
            self._handle.cancel_goal_async()

    def wait(self, limit_s: float) -> str:
        """Return how the goal ended, "" if it has not."""
        self._ended.wait(limit_s)
        return self._state

    def _on_answer(self, handle: Any) -> None:
        if not handle.accepted:
            self._end("rejected")
            return
        self._handle = handle
        self._accepted()
        result = handle.get_result_async()
        result.add_done_callback(lambda done: self._end(_STATES[done.result().status]))

    def _end(self, state: str) -> None:
        self._state = state
        self._ended.set()

"""Serves Fibonacci on `fib`: a goal takes its order in hundredths of a second.

One of an order above 1000 lasts until the file is there that the first argument names.
"""

import sys
import time
from pathlib import Path

import rclpy
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from test_msgs.action import Fibonacci

MAX_TIMED = 1000


def is_over(order, start):
    """Tell whether a goal that was started at a time (s) has lasted long enough."""
    if order > MAX_TIMED:
        return Path(sys.argv[1]).exists()
    return time.monotonic() - start >= order / 100


def execute(goal):
    order, start = goal.request.order, time.monotonic()
    print("started", order)
    while not is_over(order, start):
        if goal.is_cancel_requested:
            goal.canceled()
            print("canceled", order)
            return Fibonacci.Result()
        time.sleep(0.005)
    goal.succeed()
    print("ended", order)
    return Fibonacci.Result(sequence=[order])


def main():
    rclpy.init()
    node = rclpy.create_node("server")
    server = ActionServer(
        node,
        Fibonacci,
        "fib",
        execute,
        cancel_callback=lambda _goal: CancelResponse.ACCEPT,
        callback_group=ReentrantCallbackGroup(),
    )
    print("ready")
    try:
        rclpy.spin(node, MultiThreadedExecutor(4))
    except (KeyboardInterrupt, ExternalShutdownException):
        server.destroy()
        sys.exit(0)


if __name__ == "__main__":
    main()

"""Serves Fibonacci on `fib`: a goal takes its order in hundredths of a second."""

import sys
import time

import rclpy
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from test_msgs.action import Fibonacci


def execute(goal):
    order = goal.request.order
    print("started", order)
    until = time.monotonic() + order / 100
    while time.monotonic() < until:
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

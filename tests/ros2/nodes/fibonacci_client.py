"""Asks for each order of its arguments, one after the other, and says what comes of it.

With `--times` it says how long each took instead: until accepted and until the result, us.
"""

import sys
import time

import rclpy
from rclpy.action import ActionClient
from test_msgs.action import Fibonacci


def ask(node, client, order):
    began = time.perf_counter_ns()
    sent = client.send_goal_async(Fibonacci.Goal(order=order))
    rclpy.spin_until_future_complete(node, sent)
    accepted = time.perf_counter_ns()
    if not sent.result().accepted:
        return "rejected", (accepted - began) // 1000, 0
    done = sent.result().get_result_async()
    rclpy.spin_until_future_complete(node, done)
    ended = time.perf_counter_ns()
    answer = done.result()
    told = f"{answer.status} {list(answer.result.sequence)}"
    return told, (accepted - began) // 1000, (ended - began) // 1000


def main():
    rclpy.init()
    node = rclpy.create_node("client")
    orders = rclpy.utilities.remove_ros_args(sys.argv)[1:]
    times = "--times" in orders
    client = ActionClient(node, Fibonacci, "fib")
    print("ready")
    client.wait_for_server()
    for order in orders:
        if order != "--times":
            told, accepted, ended = ask(node, client, int(order))
            print("times" if times else order, *((accepted, ended) if times else (told,)))
    print("done")


if __name__ == "__main__":
    main()

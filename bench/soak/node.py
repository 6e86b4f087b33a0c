"""A node of the soaked app: `python -m bench.soak.node ROS ROLE [ARGUMENT]`, on rospy or rclpy.

It imports nothing of RTron: rospy has a Python of its own. What it writes to its file, others
judge (`base_log.py`, `policy_checks.py`, `goal_log.py`); times are of the steady clock, ns.
"""

# ruff: noqa: ANN401 - the messages of two ROS have no type in common

from __future__ import annotations

import os
import random
import signal
import sys
import time
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any, TextIO

from bench.soak import names

if TYPE_CHECKING:
    from collections.abc import Callable

_NICE = 5
_TICK_S, _STALL_S = 0.005, 0.02
_GOAL_LIMIT_S, _PAUSE_S = 20.0, 0.2
_FORGED_RATE = 2.0
_CANCELED = 0.3


def main() -> None:
    """Be a node until told to end."""
    ros, role, *rest = sys.argv[1:]
    arguments = [each for each in rest if ":=" not in each and not each.startswith("-")]
    signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
    graph = import_module(f"bench.soak.ros{ros}_graph").Graph(role)
    _ROLES[role](graph, *arguments)
    graph.spin()


def _navigate(graph: Any) -> None:
    graph.publish(names.FLOW, _twist(), names.RATE)


def _steer_by_hand(graph: Any) -> None:
    graph.publish(names.LOWER_FLOW, _twist(side=names.SIDE), names.RATE)


def _trespass(graph: Any) -> None:
    """Speak to the guard as who is not in the plan, on public and on private names."""
    for topic in (names.COMMANDS, names.FLOW):
        graph.publish(topic, _twist(names.FORBIDDEN, turn=names.TURN), names.RATE)
    graph.forge_goals(_FORGED_RATE)


def _intrude(graph: Any) -> None:
    """Go past the guard."""
    graph.publish(names.OUT, _twist(names.INTRUDING, turn=-names.TURN), names.INTRUDER_RATE)


def _drive(graph: Any, path: str) -> None:
    """Write what the navigation demands and what the guard lets go, and when nothing ran here."""
    file = Path(path).open("a", buffering=1)  # noqa: SIM115 - as long as the process
    kind = type(_twist())

    def write(twist: Any) -> None:
        linear, turn = twist.linear, twist.angular.z
        file.write(f"out {time.monotonic_ns()} {linear.x:g} {linear.y:g} {turn:g}\n")

    def write_input(twist: Any) -> None:
        if twist.linear.x == names.SPEED:
            file.write(f"in {time.monotonic_ns()} {twist.linear.x:g} 0 0\n")

    Thread(target=_write_stalls, args=[file], daemon=True).start()
    graph.listen(names.FLOW, kind, write_input)
    graph.listen(names.OUT, kind, write)


def _write_stalls(file: TextIO) -> None:
    """Write when this process did not run for a while, and for how long, s."""
    while True:
        begin = time.monotonic_ns()
        time.sleep(_TICK_S)
        stalled_s = (time.monotonic_ns() - begin) / 1e9 - _TICK_S
        if stalled_s > _STALL_S:
            file.write(f"stall {begin} {stalled_s:.3f} 0 0\n")


def _see(graph: Any, path: str) -> None:
    """Write when each picture came."""
    os.nice(_NICE)
    write = _time_writer(path)
    graph.listen(names.IMAGE_OUT, type(_message("sensor_msgs/Image")), lambda _: write())


def _film(graph: Any, path: str, rate: str) -> None:
    """Make pictures, and write when."""
    os.nice(_NICE)
    message = _message("sensor_msgs/Image")
    message.height, message.width, message.encoding = 1, names.IMAGE_BYTES, "mono8"
    message.step, message.data = names.IMAGE_BYTES, bytes(names.IMAGE_BYTES)
    graph.publish(names.IMAGE_FLOW, message, float(rate), _time_writer(path))


def _detect(graph: Any, path: str) -> None:
    """Say whether a person is there, which SIGUSR1 changes; write each word."""
    person = _message("std_msgs/Bool")

    def turn(*_: object) -> None:
        person.data = not person.data

    signal.signal(signal.SIGUSR1, turn)
    write = _time_writer(path, lambda: f" {int(person.data)}")
    graph.publish(names.PERSON, person, names.EVENT_RATE, write)


def _time_writer(path: str, more: Callable[[], str] = str) -> Callable[[], object]:
    file = Path(path).open("a", buffering=1)  # noqa: SIM115 - as long as the process
    return lambda: file.write(f"{time.monotonic_ns()}{more()}\n")


def _dock(graph: Any, path: str) -> None:
    """Serve goals, which are hundredths of a second of work, and write each."""
    file = Path(path).open("a", buffering=1)  # noqa: SIM115 - as long as the process

    def work(goal: int, is_cancelled: Callable[[], bool]) -> bool:
        file.write(f"{time.monotonic_ns()} {goal}\n")
        end = time.monotonic() + goal / 100
        while time.monotonic() < end and not is_cancelled():
            time.sleep(_TICK_S)
        return time.monotonic() >= end

    graph.serve(work)


def _plan(graph: Any, path: str) -> None:
    """Send goals, cancel some, and write what became of each."""
    file = Path(path).open("a", buffering=1)  # noqa: SIM115 - as long as the process
    Thread(target=_send_goals, args=[graph, file], daemon=True).start()


def _send_goals(graph: Any, file: TextIO) -> None:
    client, chance = graph.client(), random.Random()
    number = 0
    while True:
        number += 1
        _send_goal(client, chance, lambda what, n=number: _write(file, n, what))
        time.sleep(_PAUSE_S)


def _write(file: TextIO, number: int, what: str) -> None:
    file.write(f"{time.monotonic_ns()} {number} {what}\n")


def _send_goal(client: Any, chance: random.Random, write: Callable[[str], None]) -> None:
    duration = chance.randrange(10, 150)
    client.wait_for_server()
    write("sent")
    goal = client.send(duration, lambda: write("accepted"))
    state = ""
    if chance.random() < _CANCELED:
        state = goal.wait(chance.uniform(0, duration / 100))
        if not state:
            write("cancel")
            goal.cancel()
    write(state or goal.wait(_GOAL_LIMIT_S) or "lost")


def _twist(speed: float = names.SPEED, side: float = 0.0, turn: float = 0.0) -> Any:
    twist = _message("geometry_msgs/Twist")
    twist.linear.x, twist.linear.y, twist.angular.z = speed, side, turn
    return twist


def _message(name: str) -> Any:
    package, _, kind = name.partition("/")
    return getattr(import_module(f"{package}.msg"), kind)()


_ROLES = {
    "nav": _navigate,
    "joystick": _steer_by_hand,
    "rogue": _trespass,
    "intruder": _intrude,
    "base": _drive,
    "viewer": _see,
    "camera": _film,
    "detector": _detect,
    "dock": _dock,
    "planner": _plan,
}


if __name__ == "__main__":
    main()

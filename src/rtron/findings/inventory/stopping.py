"""Whether what drivers move stops by itself when commands end, as far as it can be told."""

from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.motion.command_timeout import CLEVER_DEVICES, TIMEOUT_NAMES, is_off
from rtron.vocabulary import WiringFact, WiringFactKind
from rtron.vocabulary.inventory import Stops

_KNOWN = {
    "diff_drive_controller": (Stops.YES, "cmd_vel_timeout, by default 0.5 s"),
    "mecanum_drive_controller": (Stops.YES, "reference_timeout"),
    "ackermann_steering_controller": (Stops.YES, "reference_timeout"),
    "tricycle_controller": (Stops.YES, "cmd_vel_timeout, by default 0.5 s"),
    "kobuki_node": (Stops.YES, "cmd_vel_timeout, by default 0.6 s"),
    "create_driver": (Stops.YES, "latch_cmd_duration, by default 0.2 s"),
    "turtlesim": (Stops.YES, "a turtle stops 1 s after its last command"),
    "turtlebot3_node": (Stops.UNKNOWN, "its firmware decides"),
    "gazebo_ros": (Stops.NO, "Gazebo's plugin keeps the last command"),
    "gazebo_plugins": (Stops.NO, "Gazebo's plugin keeps the last command"),
    "ros_gz_bridge": (Stops.NO, "Gazebo keeps the last command"),
    "stage_ros": (Stops.YES, "watchdog_timeout, by default 0.2 s"),
    "mavros": (Stops.YES, "the autopilot's own failsafe"),
}
"""What is documented of drivers: control.ros.org, wiki.ros.org, or their own source."""


class Stopping(NamedTuple):
    """Whether it stops, and why."""

    stops: Stops
    why: str


def stopping(app: AppFacts, drivers: tuple[str, ...], topics: Iterable[str]) -> Stopping:
    """Return the worst that is known of the drivers.

    A controller of ROS 1 is no node: its topics and its parameters are below its name.
    """
    if not drivers:
        return Stopping(Stops.UNKNOWN, "what obeys is not in this launch")
    controllers = {topic.rpartition("/")[0] for topic in topics} - app.nodes.keys()
    found = [_of_driver(app, node, controllers) for node in drivers]
    order = (Stops.NO, Stops.UNKNOWN, Stops.YES)
    return min(found, key=lambda each: order.index(each.stops))


def _of_driver(app: AppFacts, node: str, controllers: Collection[str]) -> Stopping:
    age = next(_facts(app, node, WiringFactKind.COMMAND_AGE), None)
    devices = [fact.value for fact in _facts(app, node, WiringFactKind.DEVICE)]
    if devices and not age:
        why = f"nothing in the source of {node} looks at the age of a command"
        if CLEVER_DEVICES.isdisjoint(devices):
            return Stopping(Stops.NO, why)
        return Stopping(Stops.UNKNOWN, f"{why}; what it talks to may")
    for parameter in app.graph.parameters:
        is_timeout = parameter.name.rpartition(".")[2] in TIMEOUT_NAMES
        is_number = isinstance(parameter.value, (int, float))
        if parameter.node in {node, *controllers} and is_timeout and is_number:
            is_endless = is_off(parameter.value)
            stops = Stops.NO if is_endless else Stops.YES
            return Stopping(stops, f"{parameter.node}: {parameter.name} is {parameter.value}")
    if age:
        place = "".join(f", {at.file}:{at.line}" for at in age.evidence[:1])
        return Stopping(Stops.UNKNOWN, f"{node} may look at the age of commands{place}")
    package = app.nodes[node].package if node in app.nodes else ""
    if package in _KNOWN:
        return Stopping(*_KNOWN[package])
    return Stopping(Stops.UNKNOWN, f"{node} does not tell")


def _facts(app: AppFacts, node: str, kind: WiringFactKind) -> Iterator[WiringFact]:
    return (each for each in app.graph.wiring if each.kind is kind and each.subject == node)

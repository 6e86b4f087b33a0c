"""What nodes are by their packages and names: arbiters, bridges, and what moves a robot."""

import re
from collections import defaultdict

from rtron.findings.app_facts import AppFacts
from rtron.vocabulary import NodeParameterValue, UnresolvedItem
from rtron.vocabulary.enums import HiddenPart
from rtron.vocabulary.remap_rules import expand_name
from rtron.vocabulary.ros_packages import CARRIER_PACKAGES, NETWORK_BRIDGES, are_one_stack

ARBITER_PACKAGES = frozenset(
    {
        "twist_mux",
        "yocs_cmd_vel_mux",
        "cmd_vel_mux",
        "cras_relative_positional_controller",
        "nav2_collision_monitor",
        "nav2_velocity_smoother",
        "yocs_velocity_smoother",
        "ackermann_mux",
        "joy_teleop_mux",
    }
)
_SOURCE = re.compile(r"(?P<kind>topics|locks)\.(?P<name>[^.]+)\.(?P<key>topic|priority)")
"""The parameters of an input or a lock (ROS package twist_mux)."""
_SAFETY_PACKAGES = ("nav2_collision_monitor",)
"""Arbiters that keep the robot from harm: who passes one by matters in every stack."""
_APPROACHING_PACKAGES = ("opennav_docking", "opennav_following")
"""They drive up to what such an arbiter stops for, and look for collisions themselves."""
_MOVERS = frozenset(
    {"base", "driver", "motor", "motors", "wheel", "wheels", "chassis", "controller", "drive"}
    | {"serial", "rosserial", "firmware", "mcu", "vesc", "roboclaw", "arduino", "teensy"}
    | {"kinematics", "differential", "sdk", "servo", "servos", "hardware", "relayboard"}
    | {"arm", "gripper", "manipulator", "autopilot", "drone", "thruster", "thrusters"}
)
"""Words in the names of nodes and packages that move a robot."""


def arbiters(app: AppFacts) -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
    """Return the arbiters of an app, each with its inputs and its outputs of motion commands."""
    found = {}
    for node in app.graph.nodes:
        if node.package in ARBITER_PACKAGES:
            inputs = _motion(app, [e.topic for e in app.graph.subscribed_by(node.name)])
            outputs = _motion(app, [e.topic for e in app.graph.published_by(node.name)])
            if inputs and outputs:
                found[node.name] = (inputs, outputs)
    return found


def is_one_stack(app: AppFacts, nodes: tuple[str, ...]) -> bool:
    """Return whether nodes belong to one stack, which lets one of them drive at a time."""
    packages = [app.nodes[node].package if node in app.nodes else "" for node in nodes]
    bound = [each for each in packages if each not in _APPROACHING_PACKAGES]
    is_passed_by = len(bound) > 1 and not set(bound).isdisjoint(_SAFETY_PACKAGES)
    return are_one_stack(packages) and not is_passed_by


def _motion(app: AppFacts, topics: list[str]) -> tuple[str, ...]:
    return tuple(sorted({topic for topic in topics if app.is_motion(topic)}))


def priorities(app: AppFacts, node: str, kind: str = "topics") -> dict[str, str]:
    """Return the priorities that a twist_mux gives its inputs, or its `locks`, by topic."""
    sources: dict[str, dict[str, NodeParameterValue | None]] = defaultdict(dict)
    for each in app.graph.parameters:
        match = _SOURCE.fullmatch(each.name) if each.node == node else None
        if match and match["kind"] == kind:
            sources[match["name"]][match["key"]] = each.value
    return {
        expand_name(str(source.get("topic")), node): _written(source.get("priority"))
        for source in sources.values()
    }


def _written(value: NodeParameterValue | None) -> str:
    return "" if value is None else str(value)


def bridges(app: AppFacts) -> list[str]:
    """Return the nodes that are bridges, and the packages of those that are only included."""
    nodes = [node.name for node in app.graph.nodes if node.package in NETWORK_BRIDGES]
    return [*nodes, *included_bridges(app)]


def carriers(app: AppFacts) -> frozenset[str]:
    """Return the nodes that publish and subscribe for others, which are not nodes of the app."""
    return frozenset(node.name for node in app.graph.nodes if node.package in CARRIER_PACKAGES)


def included_bridges(app: AppFacts) -> dict[str, list[UnresolvedItem]]:
    """Return the packages of bridges that are included and not read, with what says so."""
    started = {node.package for node in app.graph.nodes}
    noted: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in app.graph.unresolved:
        if note.package in NETWORK_BRIDGES.keys() - started and note.hides is HiddenPart.NODES:
            noted[note.package].append(note)
    return noted


def moves(node: str, package: str) -> bool:
    """Return whether a node and its package are called like what moves a robot."""
    name = f"{node.rpartition('/')[2]}_{package}"
    return not _MOVERS.isdisjoint(re.split("[_-]", name.lower()))

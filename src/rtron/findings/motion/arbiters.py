"""Nodes that decide between commands: multiplexers, smoothers and monitors of velocities."""

from rtron.findings.app_facts import AppFacts

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
_STACKS = ("nav2_", "move_base", "moveit", "autoware_", "gazebo_", "ros_gz")
"""Prefixes of packages whose nodes take turns among themselves."""


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
    packages = {app.nodes[node].package if node in app.nodes else "" for node in nodes}
    return any(all(package.startswith(stack) for package in packages) for stack in _STACKS)


def _motion(app: AppFacts, topics: list[str]) -> tuple[str, ...]:
    return tuple(sorted({topic for topic in topics if app.is_motion(topic)}))

"""Ways to move the robot that no topic of the plan leads through: services, actions, parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.vocabulary import PRIVATE_ROOT, Plan, Service, UnguardedPath
from rtron.vocabulary.verification import unguarded_paths

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
    from rtron.guard.audit.ros2.observed_graph import ObservedGraph

_SEND_GOAL_SUFFIX = "/_action/send_goal"
_ACTION_INFIX = "/_action/"
_HARMLESS_TYPES = frozenset(
    {
        "composition_interfaces/srv/ListNodes",
        "lifecycle_msgs/srv/GetAvailableStates",
        "lifecycle_msgs/srv/GetAvailableTransitions",
        "lifecycle_msgs/srv/GetState",
        "nav_msgs/srv/GetMap",
        "rcl_interfaces/srv/DescribeParameters",
        "rcl_interfaces/srv/GetLoggerLevels",
        "rcl_interfaces/srv/GetParameterTypes",
        "rcl_interfaces/srv/GetParameters",
        "rcl_interfaces/srv/ListParameters",
        "rcl_interfaces/srv/SetLoggerLevels",
        "tf2_msgs/srv/FrameGraph",
        "type_description_interfaces/srv/GetTypeDescription",
    }
)
_EFFECTS_ON_PLANNED_NODES = {
    "lifecycle_msgs/srv/ChangeState": "starts and stops",
    "rcl_interfaces/srv/SetParameters": "changes parameters of",
    "rcl_interfaces/srv/SetParametersAtomically": "changes parameters of",
}
_EFFECTS_ON_CONTAINERS = {
    "composition_interfaces/srv/LoadNode": "puts nodes into the process of",
    "composition_interfaces/srv/UnloadNode": "takes nodes out of the process of",
}


def unguarded_interfaces(
    plan: Plan, expected: ExpectedGraph, observed: ObservedGraph
) -> Iterator[UnguardedPath]:
    """Yield what the plan lets be or cannot reach, then what the running nodes offer."""
    services = sorted(set(observed.services), key=lambda each: (each.name, each.node))
    running = (path for each in services for path in _unguarded_service(expected, each))
    yield from unguarded_paths(plan, running)


def _unguarded_service(expected: ExpectedGraph, service: Service) -> Iterator[UnguardedPath]:
    """Yield a service, or the action that it belongs to, if it can move the robot."""
    name, node = service.name, service.node
    if service.type in _EFFECTS_ON_CONTAINERS:
        yield UnguardedPath(what=name, why=f"{_EFFECTS_ON_CONTAINERS[service.type]} {node}")
    elif service.type in _EFFECTS_ON_PLANNED_NODES and expected.is_planned(node):
        yield UnguardedPath(
            what=name,
            why=f"{_EFFECTS_ON_PLANNED_NODES[service.type]} {node}, {_position(expected, node)}",
        )
    elif name.endswith(_SEND_GOAL_SUFFIX) and expected.is_successor(node):
        action = name.removesuffix(_SEND_GOAL_SUFFIX)
        if action not in expected.actions and not action.startswith(PRIVATE_ROOT + "/"):
            why = f"is an action of {node}, behind the guard, which the plan does not guard"
            yield UnguardedPath(what=action, why=why)
    elif expected.is_successor(node) and _ACTION_INFIX not in name and not _is_harmless(service):
        yield UnguardedPath(what=name, why=f"is a service of {node}, behind the guard")


def _position(expected: ExpectedGraph, node: str) -> str:
    return "behind the guard" if expected.is_successor(node) else "which the guard listens to"


def _is_harmless(service: Service) -> bool:
    return service.type in _HARMLESS_TYPES or service.type in _EFFECTS_ON_PLANNED_NODES

"""Ways to move the robot that no topic of the plan leads through: services, actions, parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.ros1.verification import Unguarded
from rtron.vocabulary import PRIVATE_ROOT, Mode, Plan, Service, streams

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.ros2.expected_graph import Wanted
    from rtron.guard.audit.ros2.observed_graph import Seen

_GOALS = "/_action/send_goal"
_ACTION = "/_action/"
_HARMLESS = frozenset(
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
_ON_PLANNED = {
    "lifecycle_msgs/srv/ChangeState": "starts and stops",
    "rcl_interfaces/srv/SetParameters": "changes parameters of",
    "rcl_interfaces/srv/SetParametersAtomically": "changes parameters of",
}
_ON_CONTAINERS = {
    "composition_interfaces/srv/LoadNode": "puts nodes into the process of",
    "composition_interfaces/srv/UnloadNode": "takes nodes out of the process of",
}


def unguarded(plan: Plan, wanted: Wanted, seen: Seen) -> Iterator[Unguarded]:
    """Yield what the plan lets be or cannot reach, then what the running nodes offer."""
    for stream in streams(plan):
        if stream.mode is Mode.OBSERVE:
            yield Unguarded(what=stream.topic, why="is only observed: everybody can publish it")
    for what in plan.accept_unenforceable:
        yield Unguarded(what=what, why="cannot be closed, and was accepted")
    for service in sorted(set(seen.services), key=lambda each: (each.name, each.node)):
        yield from _offered(wanted, service)


def _offered(wanted: Wanted, service: Service) -> Iterator[Unguarded]:
    """Yield a service, or the action that it belongs to, if it can move the robot."""
    name, node = service.name, service.node
    if service.type in _ON_CONTAINERS:
        yield Unguarded(what=name, why=f"{_ON_CONTAINERS[service.type]} {node}")
    elif service.type in _ON_PLANNED and wanted.plans(node):
        yield Unguarded(
            what=name, why=f"{_ON_PLANNED[service.type]} {node}, {_where(wanted, node)}"
        )
    elif name.endswith(_GOALS) and wanted.succeeds(node):
        action = name.removesuffix(_GOALS)
        if action not in wanted.actions and not action.startswith(PRIVATE_ROOT + "/"):
            why = f"is an action of {node}, behind the guard, which the plan does not guard"
            yield Unguarded(what=action, why=why)
    elif wanted.succeeds(node) and _ACTION not in name and not _is_harmless(service):
        yield Unguarded(what=name, why=f"is a service of {node}, behind the guard")


def _where(wanted: Wanted, node: str) -> str:
    return "behind the guard" if wanted.succeeds(node) else "which the guard listens to"


def _is_harmless(service: Service) -> bool:
    return service.type in _HARMLESS or service.type in _ON_PLANNED

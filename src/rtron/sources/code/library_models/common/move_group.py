"""What a client of MoveIt's move_group joins, in both languages and both ROS.

Source: moveit and moveit2, move_group_interface.cpp; moveit_commander wraps it.
"""

from collections.abc import Iterator

from rtron.sources.declaration import DeclarationKind

_ACTION = DeclarationKind.ACTION_CLIENT
_SERVICE = DeclarationKind.SERVICE_CLIENT
_ENDPOINTS = (
    (_ACTION, "move_group", "moveit_msgs/MoveGroup"),
    (_ACTION, "execute_trajectory", "moveit_msgs/ExecuteTrajectory"),
    (DeclarationKind.PUBLISH, "trajectory_execution_event", "std_msgs/String"),
    (DeclarationKind.PUBLISH, "attached_collision_object", "moveit_msgs/AttachedCollisionObject"),
    (_SERVICE, "query_planner_interface", "moveit_msgs/QueryPlannerInterfaces"),
    (_SERVICE, "get_planner_params", "moveit_msgs/GetPlannerParams"),
    (_SERVICE, "set_planner_params", "moveit_msgs/SetPlannerParams"),
    (_SERVICE, "compute_cartesian_path", "moveit_msgs/GetCartesianPath"),
)


def move_group_endpoints(ros: int) -> Iterator[tuple[DeclarationKind, str, str, bool]]:
    """Yield kind, name and type of each endpoint, and whether only the library itself uses it."""
    for kind, name, type in _ENDPOINTS:
        is_action = kind is _ACTION
        yield kind, name, f"{type}Action" if is_action and ros == 1 else type, not is_action

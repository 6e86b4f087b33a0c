"""What nav2_bringup/launch/navigation_launch.py starts.

Read at github.com/ros-navigation/navigation2@aa3dab8d;
the branches from humble on differ in the servers, their remaps and their namespace.
"""

import os
from typing import Any

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LoadComposableNodes, Node, PushROSNamespace, SetParameter
from launch_ros.descriptions import ComposableNode, ParameterFile
from launch_ros.substitutions import FindPackageShare
from nav2_common.launch import RewrittenYaml

DISTRO = os.environ.get("ROS_DISTRO", "rolling")
FRAMES = [("/tf", "tf"), ("/tf_static", "tf_static")]
CHECKED = [("cmd_vel", "cmd_vel_nav")]
SMOOTHED = CHECKED if DISTRO >= "jazzy" else [*CHECKED, ("cmd_vel_smoothed", "cmd_vel")]
MANAGER = "lifecycle_manager_navigation"
PROGRAMS = {
    "docking_server": "opennav_docking",
    "following_server": "opennav_following",
    MANAGER: "lifecycle_manager",
}


def servers() -> list[tuple[str, str, str]]:
    """Return the names, packages and plugins of the servers."""
    found = [
        ("controller_server", "nav2_controller", "nav2_controller::ControllerServer"),
        ("smoother_server", "nav2_smoother", "nav2_smoother::SmootherServer"),
        ("planner_server", "nav2_planner", "nav2_planner::PlannerServer"),
        ("behavior_server", "nav2_behaviors", "behavior_server::BehaviorServer"),
        ("bt_navigator", "nav2_bt_navigator", "nav2_bt_navigator::BtNavigator"),
        ("waypoint_follower", "nav2_waypoint_follower", "nav2_waypoint_follower::WaypointFollower"),
        ("velocity_smoother", "nav2_velocity_smoother", "nav2_velocity_smoother::VelocitySmoother"),
    ]
    if DISTRO >= "jazzy":
        found += [
            ("route_server", "nav2_route", "nav2_route::RouteServer"),
            (
                "collision_monitor",
                "nav2_collision_monitor",
                "nav2_collision_monitor::CollisionMonitor",
            ),
            ("docking_server", "opennav_docking", "opennav_docking::DockingServer"),
        ]
    if DISTRO >= "lyrical":
        found += [("following_server", "opennav_following", "opennav_following::FollowingServer")]
    return found


def remaps(name: str) -> list[tuple[str, str]]:
    """Return the remaps of a server."""
    if name == "controller_server" or (name == "behavior_server" and DISTRO >= "jazzy"):
        return [*FRAMES, *CHECKED]
    return [*FRAMES, *SMOOTHED] if name == "velocity_smoother" else FRAMES


def parameters(name: str) -> list[Any]:
    """Return the parameters of a server, or of their manager."""
    autostart = LaunchConfiguration("autostart")
    if name == MANAGER:
        return [{"autostart": autostart, "node_names": [server for server, *_ in servers()]}]
    rewritten = RewrittenYaml(
        source_file=LaunchConfiguration("params_file"),
        root_key=LaunchConfiguration("namespace"),
        param_rewrites={"autostart": autostart},
        convert_types=True,
    )
    graph = {"graph_filepath": LaunchConfiguration("graph", default="")}
    file = ParameterFile(rewritten, allow_substs=True)
    return [file, graph] if name == "route_server" else [file]


def generate_launch_description() -> LaunchDescription:
    """Return the servers as processes, or as components of a container."""
    namespace = LaunchConfiguration("namespace")
    use_composition = LaunchConfiguration("use_composition")
    manager = (MANAGER, "nav2_lifecycle_manager", "nav2_lifecycle_manager::LifecycleManager")
    started = [*servers(), manager]
    nodes = [
        Node(
            package=package,
            executable=PROGRAMS.get(name, name),
            name=name,
            parameters=parameters(name),
            remappings=remaps(name),
        )
        for name, package, _ in started
    ]
    components = [
        ComposableNode(
            package=package,
            plugin=plugin,
            name=name,
            parameters=parameters(name),
            remappings=remaps(name),
        )
        for name, package, plugin in started
    ]
    loaded = LoadComposableNodes(
        target_container=(namespace, "/", LaunchConfiguration("container_name")),
        composable_node_descriptions=components,
    )
    scope = [SetParameter("use_sim_time", LaunchConfiguration("use_sim_time"))]
    scope += [PushROSNamespace(namespace)] if DISTRO >= "lyrical" else []
    return LaunchDescription(
        [
            *arguments(),
            GroupAction([*scope, *nodes], condition=UnlessCondition(use_composition)),
            GroupAction([*scope, loaded], condition=IfCondition(use_composition)),
        ]
    )


def arguments() -> list[DeclareLaunchArgument]:
    """Return the arguments that decide what starts."""
    file = [FindPackageShare("nav2_bringup"), "/params/nav2_params.yaml"]
    defaults = {
        "namespace": "",
        "use_sim_time": "false",
        "params_file": file,
        "autostart": "true",
        "use_composition": "False",
        "container_name": "nav2_container",
    }
    return [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]

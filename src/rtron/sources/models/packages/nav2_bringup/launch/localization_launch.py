"""What nav2_bringup/launch/localization_launch.py starts.

Read at github.com/ros-navigation/navigation2@aa3dab8d;
the branches from humble on differ in their namespace alone.
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
MANAGER = "lifecycle_manager_localization"
STARTED = [
    ("map_server", "nav2_map_server", "nav2_map_server::MapServer"),
    ("amcl", "nav2_amcl", "nav2_amcl::AmclNode"),
    (MANAGER, "nav2_lifecycle_manager", "nav2_lifecycle_manager::LifecycleManager"),
]


def parameters(name: str) -> list[Any]:
    """Return the parameters of a server, or of their manager."""
    if name == MANAGER:
        autostart = LaunchConfiguration("autostart")
        return [{"autostart": autostart, "node_names": ["map_server", "amcl"]}]
    rewritten = RewrittenYaml(
        source_file=LaunchConfiguration("params_file"),
        root_key=LaunchConfiguration("namespace"),
        param_rewrites={},
        convert_types=True,
    )
    file = ParameterFile(rewritten, allow_substs=True)
    return [file, {"yaml_filename": LaunchConfiguration("map")}] if name == "map_server" else [file]


def generate_launch_description() -> LaunchDescription:
    """Return the servers as processes, or as components of a container."""
    namespace = LaunchConfiguration("namespace")
    use_composition = LaunchConfiguration("use_composition")
    nodes = [
        Node(
            package=package,
            executable="lifecycle_manager" if name == MANAGER else name,
            name=name,
            parameters=parameters(name),
            remappings=FRAMES,
        )
        for name, package, _ in STARTED
    ]
    components = [
        ComposableNode(
            package=package,
            plugin=plugin,
            name=name,
            parameters=parameters(name),
            remappings=FRAMES,
        )
        for name, package, plugin in STARTED
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
        "map": "",
        "use_sim_time": "false",
        "params_file": file,
        "autostart": "true",
        "use_composition": "False",
        "container_name": "nav2_container",
    }
    return [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]

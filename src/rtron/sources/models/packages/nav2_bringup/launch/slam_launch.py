"""What nav2_bringup/launch/slam_launch.py starts.

Read at github.com/ros-navigation/navigation2@aa3dab8d;
the branches from humble on differ in remaps and namespace.
"""

import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node, PushROSNamespace, SetParameter, SetRemap
from launch_ros.descriptions import ParameterFile
from launch_ros.substitutions import FindPackageShare
from nav2_common.launch import HasNodeParams, RewrittenYaml

DISTRO = os.environ.get("ROS_DISTRO", "rolling")
REMAPPED = ("scan", "tf", "tf_static", "map") if DISTRO >= "jazzy" else ()


def generate_launch_description() -> LaunchDescription:
    """Return the map saver with its manager, and slam_toolbox."""
    namespace, params_file = LaunchConfiguration("namespace"), LaunchConfiguration("params_file")
    use_sim_time = LaunchConfiguration("use_sim_time")
    file = RewrittenYaml(
        source_file=params_file, root_key=namespace, param_rewrites={}, convert_types=True
    )
    saver = Node(
        package="nav2_map_server",
        executable="map_saver_server",
        parameters=[ParameterFile(file, allow_substs=True)],
    )
    managed = {"autostart": LaunchConfiguration("autostart"), "node_names": ["map_saver"]}
    manager = Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name="lifecycle_manager_slam",
        parameters=[managed],
    )
    has_parameters = HasNodeParams(source_file=params_file, node_name="slam_toolbox")
    slam = [FindPackageShare("slam_toolbox"), "/launch/online_sync_launch.py"]
    given = {"use_sim_time": use_sim_time, "slam_params_file": params_file}
    plain = IncludeLaunchDescription(
        slam,
        launch_arguments={"use_sim_time": use_sim_time}.items(),
        condition=UnlessCondition(has_parameters),
    )
    configured = IncludeLaunchDescription(
        slam, launch_arguments=given.items(), condition=IfCondition(has_parameters)
    )
    scope = [PushROSNamespace(namespace)] if DISTRO >= "lyrical" else []
    remaps = [SetRemap(f"/{name}", name) for name in REMAPPED]
    return LaunchDescription(
        [
            *arguments(),
            GroupAction([*scope, SetParameter("use_sim_time", use_sim_time), saver, manager]),
            GroupAction([*scope, *remaps, plain, configured]),
        ]
    )


def arguments() -> list[DeclareLaunchArgument]:
    """Return the arguments that decide what starts."""
    file = [FindPackageShare("nav2_bringup"), "/params/nav2_params.yaml"]
    defaults = {"namespace": "", "params_file": file, "use_sim_time": "True", "autostart": "True"}
    return [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]

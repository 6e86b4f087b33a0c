"""What nav2_bringup/launch/rviz_launch.py starts.

Read at github.com/ros-navigation/navigation2@aa3dab8d;
the branches from humble on differ in remaps, and in what becomes of the namespace.
"""

import os
from typing import Any

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare
from nav2_common.launch import ReplaceString

DISTRO = os.environ.get("ROS_DISTRO", "rolling")
FRAMES = ("tf", "tf_static")
TOPICS = ("goal_pose", "clicked_point", "initialpose")
REMAPPED = FRAMES if DISTRO >= "kilted" else ("map", *FRAMES, *TOPICS)


def rviz(file: object, **given: Any) -> Node:  # noqa: ANN401 - what Node gets
    """Return rviz with a configuration."""
    use_sim_time = {"use_sim_time": LaunchConfiguration("use_sim_time")}
    words = ["-d", file]
    return Node(
        package="rviz2", executable="rviz2", arguments=words, parameters=[use_sim_time], **given
    )


def generate_launch_description() -> LaunchDescription:
    """Return rviz, in the namespace or not."""
    namespace, file = LaunchConfiguration("namespace"), LaunchConfiguration("rviz_config")
    use_namespace = LaunchConfiguration("use_namespace")
    inside = {"namespace": namespace, "remappings": [(f"/{name}", name) for name in REMAPPED]}
    if DISTRO >= "kilted":
        started = [rviz(file, **inside)]
    else:
        replaced = ReplaceString(
            source_file=file, replacements={"<robot_namespace>": ("/", namespace)}
        )
        started = [
            rviz(file, condition=UnlessCondition(use_namespace)),
            rviz(replaced, condition=IfCondition(use_namespace), **inside),
        ]
    defaults = {
        "namespace": "navigation",
        "use_namespace": "false",
        "rviz_config": [FindPackageShare("nav2_bringup"), "/rviz/nav2_default_view.rviz"],
        "use_sim_time": "false",
    }
    declared = [
        DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()
    ]
    return LaunchDescription([*declared, *started])

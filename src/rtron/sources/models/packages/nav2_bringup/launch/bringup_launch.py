"""What nav2_bringup/launch/bringup_launch.py starts.

Read at github.com/ros-navigation/navigation2@aa3dab8d;
the branches from humble on differ in the namespace and the zones.
"""

import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node, PushROSNamespace
from launch_ros.descriptions import ParameterFile
from launch_ros.substitutions import FindPackageShare
from nav2_common.launch import ReplaceString, RewrittenYaml

DISTRO = os.environ.get("ROS_DISTRO", "rolling")
SLAM, LOCALIZED = LaunchConfiguration("slam"), LaunchConfiguration("use_localization")
USED = ("namespace", "use_sim_time", "autostart", "use_composition", "container_name")
ZONES = ("keepout", "speed") if DISTRO >= "kilted" else ()


def parameter_file() -> LaunchConfiguration | ReplaceString:
    """Return the parameter file, until Jazzy with the namespace written into it."""
    file, namespace = LaunchConfiguration("params_file"), LaunchConfiguration("namespace")
    if DISTRO >= "kilted":
        return file
    return ReplaceString(
        source_file=file,
        replacements={"<robot_namespace>": ("/", namespace)},
        condition=IfCondition(LaunchConfiguration("use_namespace")),
    )


def include(name: str, condition: IfCondition | None, **given: object) -> IncludeLaunchDescription:
    """Return the inclusion of a launch file beside this one."""
    arguments = {key: LaunchConfiguration(key) for key in USED}
    return IncludeLaunchDescription(
        [FindPackageShare("nav2_bringup"), f"/launch/{name}_launch.py"],
        launch_arguments={**arguments, "params_file": parameter_file(), **given}.items(),
        condition=condition,
    )


def container() -> Node:
    """Return the container of the servers."""
    rewritten = RewrittenYaml(
        source_file=parameter_file(),
        root_key=LaunchConfiguration("namespace"),
        param_rewrites={},
        convert_types=True,
    )
    file = ParameterFile(rewritten, allow_substs=True)
    lyrical = DISTRO >= "lyrical"
    return Node(
        package="rclcpp_components",
        executable="component_container" if lyrical else "component_container_isolated",
        name=LaunchConfiguration("container_name"),
        namespace=LaunchConfiguration("namespace") if lyrical else None,
        parameters=[file, {"autostart": LaunchConfiguration("autostart")}],
        remappings=[("/tf", "tf"), ("/tf_static", "tf_static")],
        condition=IfCondition(LaunchConfiguration("use_composition")),
    )


def scope() -> list[PushROSNamespace]:
    """Return what puts all into the namespace: since Lyrical the files do it themselves."""
    namespace = LaunchConfiguration("namespace")
    if DISTRO >= "lyrical":
        return []
    if DISTRO >= "kilted":
        return [PushROSNamespace(namespace)]
    condition = IfCondition(LaunchConfiguration("use_namespace"))
    return [PushROSNamespace(namespace, condition=condition)]


def generate_launch_description() -> LaunchDescription:
    """Return the container, SLAM or localization, and the navigation."""
    slam = IfCondition(PythonExpression([SLAM, " and ", LOCALIZED]))
    localized = IfCondition(PythonExpression(["not ", SLAM, " and ", LOCALIZED]))
    zones = [
        include(
            f"{zone}_zone",
            IfCondition(LaunchConfiguration(f"use_{zone}_zones")),
            **{f"{zone}_mask": LaunchConfiguration(f"{zone}_mask")},
        )
        for zone in ZONES
    ]
    included = [
        include("slam", slam),
        include("localization", localized, map=LaunchConfiguration("map")),
        *zones,
        include("navigation", None),
    ]
    return LaunchDescription([*arguments(), GroupAction([*scope(), container(), *included])])


def arguments() -> list[DeclareLaunchArgument]:
    """Return the arguments that decide what starts."""
    defaults = {
        "namespace": "",
        "use_namespace": "false",
        "slam": "False",
        "map": "",
        "use_localization": "True",
        "use_sim_time": "false",
        "params_file": [FindPackageShare("nav2_bringup"), "/params/nav2_params.yaml"],
        "autostart": "true",
        "use_composition": "True",
        "container_name": "nav2_container",
        **{f"use_{zone}_zones": "True" for zone in ZONES},
        **{f"{zone}_mask": "" for zone in ZONES},
    }
    return [DeclareLaunchArgument(name, default_value=value) for name, value in defaults.items()]

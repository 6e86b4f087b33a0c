# ruff: noqa: INP001 - a launch file, not a package
"""Starts the guard alone: `ros2 launch rtron guard.launch.py plan:=rtron.yaml`.

A guarded launch, as `rtron instrument` writes it, starts its own.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return the guard for the plan that is given."""
    plan = DeclareLaunchArgument("plan", description="The plan, rtron.yaml.")
    guard = Node(
        package="rtron",
        executable="guard",
        arguments=["--plan", LaunchConfiguration("plan")],
        output="screen",
        respawn=True,
    )
    return LaunchDescription([plan, guard])

"""`rtron guard` as ROS 2 starts it: `ros2 run rtron guard`, or a `Node` of a launch file."""

import sys

from rtron.cli.main import main

_ROS_ARGS = "--ros-args"


def run_guard_node() -> None:
    """Run the guard; what ROS appends behind `--ros-args` is for nodes that use rcl's parser."""
    arguments = sys.argv[1:]
    sys.argv[1:] = [
        "guard",
        *(arguments[: arguments.index(_ROS_ARGS)] if _ROS_ARGS in arguments else arguments),
    ]
    main()

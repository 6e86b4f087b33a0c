"""The actions of ROS 2's launch files that start nothing."""

PUSHES = frozenset({"push_ros_namespace", "push-ros-namespace"})

SETTINGS = PUSHES | {
    "arg",
    "let",
    "set_remap",
    "reset",
    "set_env",
    "unset_env",
    "append_env",
    "reset_env",
}
"""What changes the scope for all that comes after it."""

HARMLESS = frozenset(
    {
        "log",
        "log_debug",
        "log_info",
        "log_warning",
        "log_error",
        "shutdown",
        "set_parameter",
        "set_parameters_from_file",
        "set_ros_log_dir",
        "set_use_sim_time",
        "lifecycle_transition",
    }
)
"""What neither starts a node nor changes a name."""

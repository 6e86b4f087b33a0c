from launch.core import (
    Action,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    Substitution,
)

__all__ = [
    "Action",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "Substitution",
]

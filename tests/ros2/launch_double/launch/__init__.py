from launch.core import (
    Action,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    Substitution,
)
from launch.service import LaunchService

__all__ = [
    "Action",
    "LaunchContext",
    "LaunchDescription",
    "LaunchDescriptionEntity",
    "LaunchService",
    "Substitution",
]

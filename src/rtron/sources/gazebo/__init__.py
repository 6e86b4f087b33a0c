"""Gazebo's plugins, joints and transmissions, as robot descriptions and worlds name them."""

from rtron.sources.gazebo.joints import (
    Joint,
    Transmission,
    TransmittedJoint,
    joints_of,
    transmissions_of,
)
from rtron.sources.gazebo.plugins import (
    GazeboPlugin,
    PluginScope,
    PluginValue,
    Sensor,
    plugin_library,
    read_plugins,
)
from rtron.sources.gazebo.world import GazeboWorld, model_folders, read_world

__all__ = [
    "GazeboPlugin",
    "GazeboWorld",
    "Joint",
    "PluginScope",
    "PluginValue",
    "Sensor",
    "Transmission",
    "TransmittedJoint",
    "joints_of",
    "model_folders",
    "plugin_library",
    "read_plugins",
    "read_world",
    "transmissions_of",
]

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
    plugins_of,
)
from rtron.sources.gazebo.world import World, model_folders, read_world

__all__ = [
    "GazeboPlugin",
    "Joint",
    "PluginScope",
    "PluginValue",
    "Sensor",
    "Transmission",
    "TransmittedJoint",
    "World",
    "joints_of",
    "model_folders",
    "plugin_library",
    "plugins_of",
    "read_world",
    "transmissions_of",
]

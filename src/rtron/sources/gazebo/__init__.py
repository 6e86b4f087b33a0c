"""Gazebo's plugins, as robot descriptions and worlds name them."""

from rtron.sources.gazebo.plugins import (
    GazeboPlugin,
    PluginValue,
    Sensor,
    plugin_library,
    read_plugins,
    read_sensors,
)
from rtron.sources.gazebo.world import GazeboWorld, model_folders, read_world

__all__ = [
    "GazeboPlugin",
    "GazeboWorld",
    "PluginValue",
    "Sensor",
    "model_folders",
    "plugin_library",
    "read_plugins",
    "read_sensors",
    "read_world",
]

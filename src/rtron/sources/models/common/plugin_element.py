"""A Gazebo plugin where it stands in a robot description or a world, as its model sees it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rtron.sources.gazebo import GazeboPlugin
from rtron.sources.models.common.values import Value


@dataclass(frozen=True, slots=True, kw_only=True)
class PluginElement:
    """A `<plugin>` of SDF or URDF: its file, its elements by name, and the sensor it stands in.

    `values` maps an element's name to its text, or to such a mapping where elements are nested;
    an element that stands several times is a list of these. `robot_namespace` is what the spawner
    adds where the element has none (gazebo_ros: spawn_model's namespace); empty for a world's own.
    """

    filename: str
    name: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)
    sensor_name: str = ""
    sensor_type: str = ""
    cameras: tuple[str, ...] = ()
    link_name: str = ""
    model_name: str = ""
    robot_namespace: str = "/"

    def variables(self) -> dict[str, Value]:
        """Return the variables that a plugin's model sees."""
        spawned = {"robotNamespace": self.robot_namespace} if self.robot_namespace else {}
        return {
            "values": {**spawned, **self.values},
            "model_name": self.model_name,
            "plugin_name": self.name,
            "sensor_name": self.sensor_name,
            "sensor_type": self.sensor_type,
            "cameras": list(self.cameras),
            "link_name": self.link_name,
        }


def plugin_element(plugin: GazeboPlugin, namespace: str) -> PluginElement:
    """Return a plugin as its model sees it, with the namespace that its spawner gives."""
    sensor = plugin.sensor
    return PluginElement(
        filename=plugin.filename,
        name=plugin.name,
        values=plugin.values,
        sensor_name=sensor.name if sensor else "",
        sensor_type=sensor.type if sensor else "",
        cameras=sensor.cameras if sensor else (),
        link_name=plugin.link,
        model_name=plugin.model,
        robot_namespace=namespace,
    )

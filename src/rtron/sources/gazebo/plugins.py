"""The Gazebo plugins of a robot description or a world: facts only, no topics.

What a plugin publishes is known by its model, which is keyed by the plugin's file (Gazebo's
tutorials: ros_gzplugins for URDF, plugins_model for SDF).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import PurePosixPath
from typing import TypeAlias

from rtron.sources.xacro import XmlElement
from rtron.vocabulary import Evidence

PluginValue: TypeAlias = "str | dict[str, PluginValue] | list[PluginValue]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """A sensor; `cameras` are the names of its one or more cameras, `topic` is empty if unset."""

    type: str
    name: str
    cameras: tuple[str, ...] = ()
    topic: str = ""
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class GazeboPlugin:
    """One `<plugin>`: its file without `lib` and `.so`, and its elements' texts by name.

    An element with elements in it is a dict, one that is written several times a list. `link` is
    the link it belongs to (URDF: the `reference`), `model` the SDF model, "" in a URDF.
    """

    filename: str
    name: str
    values: Mapping[str, PluginValue] = field(default_factory=dict)
    sensor: Sensor | None = None
    link: str = ""
    model: str = ""
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class PluginContext:
    """The model, the link and the sensor around an element."""

    model: str = ""
    link: str = ""
    sensor: Sensor | None = None

    def child_context(self, element: XmlElement) -> "PluginContext":
        """Return what stands around the contents of `element`."""
        name = element.attributes.get("name", "")
        if element.tag == "model":
            model = f"{self.model}::{name}" if self.model else name
            return PluginContext(model=model)
        if element.tag == "link":
            return replace(self, link=name)
        if element.tag == "sensor":
            return replace(self, sensor=_read_sensor(element))
        return self


def read_plugins(root: XmlElement) -> tuple[GazeboPlugin, ...]:
    """Return the plugins in the `<gazebo>` elements of a URDF, or in an SDF without its includes.

    They come in document order.
    """
    if root.tag != "robot":
        return tuple(read_plugins_below(root, PluginContext().child_context(root)))
    return tuple(
        plugin
        for gazebo in root.elements("gazebo")
        for plugin in read_plugins_below(
            gazebo, PluginContext(link=gazebo.attributes.get("reference", ""))
        )
    )


def read_sensors(root: XmlElement) -> tuple[Sensor, ...]:
    """Return the sensors of a URDF, or of an SDF without its includes."""
    found, waiting = list[Sensor](), [root]
    while waiting:
        element = waiting.pop()
        if element.tag == "sensor":
            found.append(_read_sensor(element))
        waiting.extend(element.elements())
    return tuple(found)


def read_plugins_below(element: XmlElement, context: PluginContext) -> Iterator[GazeboPlugin]:
    """Yield the plugins within an element, in document order."""
    waiting = [(child, context) for child in reversed(list(element.elements()))]
    while waiting:
        child, child_context = waiting.pop()
        if child.tag == "plugin":
            yield read_plugin(child, child_context)
            continue
        inner = child_context.child_context(child)
        waiting.extend((below, inner) for below in reversed(list(child.elements())))


def read_plugin(element: XmlElement, context: PluginContext) -> GazeboPlugin:
    """Return what a `<plugin>` says."""
    return GazeboPlugin(
        filename=plugin_library(element.attributes.get("filename", "")),
        name=element.attributes.get("name", ""),
        values=_read_values(element),
        sensor=context.sensor,
        link=context.link,
        model=context.model,
        evidence=element.evidence,
    )


def plugin_library(filename: str) -> str:
    """Return a library's name: `gazebo_ros_camera` for `libgazebo_ros_camera.so`."""
    return PurePosixPath(filename.strip()).name.removesuffix(".so").removeprefix("lib")


def _read_sensor(element: XmlElement) -> Sensor:
    cameras = (camera.attributes.get("name", "") for camera in element.elements("camera"))
    return Sensor(
        type=element.attributes.get("type", ""),
        name=element.attributes.get("name", ""),
        cameras=tuple(cameras),
        topic=topic.text if (topic := element.find("topic")) else "",
        evidence=element.evidence,
    )


def _read_values(element: XmlElement) -> dict[str, PluginValue]:
    values: dict[str, PluginValue] = {}
    for child in element.elements():
        value = _read_values(child) if any(child.elements()) else child.text
        known = values.get(child.tag)
        if known is None:
            values[child.tag] = value
        elif isinstance(known, list):
            known.append(value)
        else:
            values[child.tag] = [known, value]
    return values

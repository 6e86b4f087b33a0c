"""The launch actions of ros_gz, and its launch files, as what they start.

Source: ros_gz 2.1, ros_gz_bridge/launch and ros_gz_sim/launch: ros_gz_bridge, gz_server and
gz_spawn_model, each of which an action of the same name includes.
"""

from collections.abc import Callable, Mapping
from typing import TypeAlias

from rtron.sources.launch2.element import Element
from rtron.sources.launch2.pieces import Written

_Given: TypeAlias = Mapping[str, Written]
_SPAWN = {"file": "file", "model_string": "string", "topic": "topic", "entity_name": "name"}


def _bridge(given: _Given) -> tuple[Element, ...]:
    named = {"pkg": "ros_gz_bridge", **_texts(given, name="bridge_name", namespace="namespace")}
    inside = _parameters(given, {"config_file": "config_file"})
    return _either(given, "bridge_node", "ros_gz_bridge::RosGzBridge", named, inside)


def _server(given: _Given) -> tuple[Element, ...]:
    inside = _parameters(given, {key: key for key in ("world_sdf_file", "world_sdf_string")})
    return _either(given, "gzserver", "ros_gz_sim::GzServer", {"pkg": "ros_gz_sim"}, inside)


def _spawn(given: _Given) -> tuple[Element, ...]:
    named = {"pkg": "ros_gz_sim", "exec": "create"}
    return (Element("node", named, _parameters(given, _SPAWN)),)


def _either(
    given: _Given,
    program: str,
    plugin: str,
    named: Mapping[str, Written],
    inside: tuple[Element, ...],
) -> tuple[Element, ...]:
    """Return a program, or a component in a container of its own or of others."""
    composed, own = (given.get(key, "False") for key in ("use_composition", "create_own_container"))
    target = given.get("container_name", "ros_gz_container")
    component = (Element("composable_node", {**named, "plugin": plugin}, inside),)
    container = {"pkg": "rclcpp_components", "exec": "component_container", "name": target}
    loaded = (
        Element("node_container", {**container, "if": own}, component),
        Element("load_composable_node", {"target": target, "unless": own}, component),
    )
    return (
        Element("node", {**named, "exec": program, "unless": composed}, inside),
        Element("group", {"if": composed, "scoped": "false"}, loaded),
    )


def _texts(given: _Given, **keys: str) -> dict[str, Written]:
    return {name: given[key] for name, key in keys.items() if key in given}


def _parameters(given: _Given, names: Mapping[str, str]) -> tuple[Element, ...]:
    found = ((name, given[key]) for key, name in names.items() if key in given)
    return tuple(Element("param", {"name": name, "value": value}) for name, value in found)


_ACTIONS: Mapping[str, Callable[[_Given], tuple[Element, ...]]] = {
    "ros_gz_bridge": _bridge,
    "gz_server": _server,
    "gz_spawn_model": _spawn,
    "gz_sim": lambda _given: (),
}
_FILES = {
    "ros_gz_bridge}/launch/ros_gz_bridge.launch": "ros_gz_bridge",
    "ros_gz_sim}/launch/gz_sim.launch": "gz_sim",
    "ros_gz_sim}/launch/gz_server.launch": "gz_server",
    "ros_gz_sim}/launch/gz_spawn_model.launch": "gz_spawn_model",
}
"""How the paths of launch files end whose packages are not there."""
GAZEBO_ACTIONS = frozenset(_ACTIONS) - {"gz_sim"}


def started_by(element: Element) -> tuple[Element, ...]:
    """Return what an action of ros_gz starts."""
    return _at(element, _ACTIONS[element.tag](element.attributes))


def included_by(element: Element, path: str) -> tuple[Element, ...] | None:
    """Return what a launch file of ros_gz starts, None if it is none; it need not be there.

    gz_sim runs Gazebo alone, which is no node.
    """
    action = _FILES.get(path.rpartition(" ")[2].removesuffix(".py"))
    if action is None:
        return None
    arguments = {
        each.plain("name"): each.attributes.get("value", "") for each in element.named("arg")
    }
    return _at(element, _ACTIONS[action](arguments))


def _at(place: Element, elements: tuple[Element, ...]) -> tuple[Element, ...]:
    return tuple(each.placed(place.line, place.file) for each in elements)

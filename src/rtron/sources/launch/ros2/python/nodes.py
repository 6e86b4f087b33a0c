"""Nodes, containers and components of a Python launch file, as elements (launch_ros.actions)."""

from collections.abc import Iterator

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    MapValue,
    Value,
    options,
)
from rtron.sources.code.library_models.launch.constructor_calls import call_name, given
from rtron.sources.launch.ros2.python.actions import Actions
from rtron.sources.launch.ros2.python.parameters import entries, parameters
from rtron.sources.launch.ros2.python.substitutions import Fields
from rtron.sources.launch.ros2.substitutions.template import Call, hole
from rtron.sources.launch.ros2.xml_yaml.element import Element

_OLD = {
    "node_executable": "executable",
    "node_name": "name",
    "node_namespace": "namespace",
    "node_plugin": "plugin",
}
"""What parameters were called before ROS 2 Foxy."""


def node(actions: Actions, fields: Fields, tag: str) -> Element:
    """Return the element of a node, with the components that are to be loaded into it."""
    fields = _renamed(fields)
    attributes = actions.texts_of(
        fields, pkg="package", exec="executable", name="name", namespace="namespace"
    )
    children = (
        *actions.words("args", fields.get("arguments")),
        *actions.words("ros_args", fields.get("ros_arguments")),
        *_given(actions, fields),
        *actions.pairs("env", fields.get("env"), "name", "value"),
        *actions.pairs("env", fields.get("additional_env"), "name", "value"),
        *_components(actions, fields),
    )
    return Element(tag, attributes, children)


def load(actions: Actions, fields: Fields) -> Element:
    """Return the element of an action that loads components."""
    target = fields.get("target_container", NONE)
    text = actions.texts.pieces(target)
    if isinstance(target, Instance) and call_name(target) == "ComposableNodeContainer":
        own = given(target)
        keys = [key for key in ("name", "namespace") if own.get(key, NONE) != NONE]
        text = (Call("node-name", tuple(actions.texts.pieces(own[key]) for key in keys)),)
    return Element("load_composable_node", {"target": text}, tuple(_components(actions, fields)))


def _components(actions: Actions, fields: Fields) -> Iterator[Element]:
    items, certain = items_of(fields.get("composable_node_descriptions", NONE))
    for item in items:
        yield from (_component(actions, option) for option in options(item))
    if not certain:
        yield Element("composable_node", {"plugin": (hole("more components"),)})


def _component(actions: Actions, value: Value) -> Element:
    if not isinstance(value, Instance) or not call_name(value):
        return Element("composable_node", {"plugin": actions.texts.pieces(value)})
    fields = _renamed(given(value))
    attributes = actions.texts_of(
        fields, pkg="package", plugin="plugin", name="name", namespace="namespace"
    )
    attributes |= actions.condition(fields.get("condition", NONE))
    extra = tuple(_extra_arguments(actions, fields.get("extra_arguments", NONE)))
    made = Element("composable_node", attributes, (*_given(actions, fields), *extra))
    return actions.at(made, value)


def _extra_arguments(actions: Actions, value: Value) -> Iterator[Element]:
    for item in items_of(value)[0]:
        if isinstance(item, MapValue):
            yield from entries(actions.texts, item, "extra_arg")


def _given(actions: Actions, fields: Fields) -> tuple[Element, ...]:
    return (
        *actions.pairs("remap", fields.get("remappings"), "from", "to"),
        *parameters(actions.texts, fields.get("parameters")),
    )


def _renamed(fields: Fields) -> Fields:
    return {_OLD.get(key, key): value for key, value in fields.items()}

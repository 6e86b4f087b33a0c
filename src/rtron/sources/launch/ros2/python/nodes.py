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
from rtron.sources.code.library_models.launch.constructor_calls import (
    constructor_arguments,
    launch_class_name,
)
from rtron.sources.launch.ros2.python.actions import ActionTranslator
from rtron.sources.launch.ros2.python.parameters import entry_elements, parameter_elements
from rtron.sources.launch.ros2.python.substitutions import Fields
from rtron.sources.launch.ros2.substitutions.template import SubstitutionCall, placeholder
from rtron.sources.launch.ros2.xml_yaml.element import Element

_RENAMED_FIELDS = {
    "node_executable": "executable",
    "node_name": "name",
    "node_namespace": "namespace",
    "node_plugin": "plugin",
}
"""What parameters were called before ROS 2 Foxy."""


def node_element(actions: ActionTranslator, fields: Fields, tag: str) -> Element:
    """Return the element of a node, with the components that are to be loaded into it."""
    fields = _renamed(fields)
    attributes = actions.attributes_of(
        fields,
        pkg="package",
        exec="executable",
        name="name",
        namespace="namespace",
        autostart="autostart",
    )
    children = (
        *actions.word_elements("args", fields.get("arguments")),
        *actions.word_elements("ros_args", fields.get("ros_arguments")),
        *_remaps_and_parameters(actions, fields),
        *actions.pair_elements("env", fields.get("env"), "name", "value"),
        *actions.pair_elements("env", fields.get("additional_env"), "name", "value"),
        *_components(actions, fields),
    )
    return Element(tag, attributes, children)


def load_element(actions: ActionTranslator, fields: Fields) -> Element:
    """Return the element of an action that loads components."""
    target = fields.get("target_container", NONE)
    text = actions.translator.template(target)
    if isinstance(target, Instance) and launch_class_name(target) == "ComposableNodeContainer":
        container_fields = constructor_arguments(target)
        keys = [key for key in ("name", "namespace") if container_fields.get(key, NONE) != NONE]
        text = (
            SubstitutionCall(
                "node-name",
                tuple(actions.translator.template(container_fields[key]) for key in keys),
            ),
        )
    return Element("load_composable_node", {"target": text}, tuple(_components(actions, fields)))


def _components(actions: ActionTranslator, fields: Fields) -> Iterator[Element]:
    items, certain = items_of(fields.get("composable_node_descriptions", NONE))
    for item in items:
        yield from (_component(actions, option) for option in options(item))
    if not certain:
        yield Element("composable_node", {"plugin": (placeholder("more components"),)})


def _component(actions: ActionTranslator, value: Value) -> Element:
    if not isinstance(value, Instance) or not launch_class_name(value):
        return Element("composable_node", {"plugin": actions.translator.template(value)})
    fields = _renamed(constructor_arguments(value))
    attributes = actions.attributes_of(
        fields, pkg="package", plugin="plugin", name="name", namespace="namespace"
    )
    attributes |= actions.condition_attributes(fields.get("condition", NONE))
    extra_arguments = tuple(_extra_arguments(actions, fields.get("extra_arguments", NONE)))
    element = Element(
        "composable_node", attributes, (*_remaps_and_parameters(actions, fields), *extra_arguments)
    )
    return actions.with_call_location(element, value)


def _extra_arguments(actions: ActionTranslator, value: Value) -> Iterator[Element]:
    for item in items_of(value)[0]:
        if isinstance(item, MapValue):
            yield from entry_elements(actions.translator, item, "extra_arg")


def _remaps_and_parameters(actions: ActionTranslator, fields: Fields) -> tuple[Element, ...]:
    return (
        *actions.pair_elements("remap", fields.get("remappings"), "from", "to"),
        *parameter_elements(actions.translator, fields.get("parameters")),
    )


def _renamed(fields: Fields) -> Fields:
    return {_RENAMED_FIELDS.get(key, key): value for key, value in fields.items()}

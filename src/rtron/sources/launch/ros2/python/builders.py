"""The element that each class of actions becomes (launch.actions, launch_ros.actions)."""

from collections.abc import Iterator, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.library_models.launch.constructor_calls import (
    constructor_arguments,
    launch_class_name,
)
from rtron.sources.launch.ros2.python.actions import ActionTranslator, Attributes, Build
from rtron.sources.launch.ros2.python.parameters import (
    entry_elements,
    parameter_element,
    parameter_elements,
)
from rtron.sources.launch.ros2.python.substitutions import Fields, is_false, plain_text
from rtron.sources.launch.ros2.substitutions.template import SubstitutionCall, placeholder
from rtron.sources.launch.ros2.xml_yaml import Element

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
    target = fields.get("target_container", av.NONE)
    text = actions.translator.template(target)
    if isinstance(target, av.Instance) and launch_class_name(target) == "ComposableNodeContainer":
        container_fields = constructor_arguments(target)
        keys = [
            key for key in ("name", "namespace") if container_fields.get(key, av.NONE) != av.NONE
        ]
        text = (
            SubstitutionCall(
                "node-name",
                tuple(actions.translator.template(container_fields[key]) for key in keys),
            ),
        )
    return Element("load_composable_node", {"target": text}, tuple(_components(actions, fields)))


def _components(actions: ActionTranslator, fields: Fields) -> Iterator[Element]:
    items, certain = av.items_of(fields.get("composable_node_descriptions", av.NONE))
    for item in items:
        yield from (_component(actions, option) for option in av.options(item))
    if not certain:
        yield Element("composable_node", {"plugin": (placeholder("more components"),)})


def _component(actions: ActionTranslator, value: av.Value) -> Element:
    if not isinstance(value, av.Instance) or not launch_class_name(value):
        return Element("composable_node", {"plugin": actions.translator.template(value)})
    fields = _renamed(constructor_arguments(value))
    attributes = actions.attributes_of(
        fields, pkg="package", plugin="plugin", name="name", namespace="namespace"
    )
    attributes |= actions.condition_attributes(fields.get("condition", av.NONE))
    extra_arguments = tuple(_extra_arguments(actions, fields.get("extra_arguments", av.NONE)))
    element = Element(
        "composable_node", attributes, (*_remaps_and_parameters(actions, fields), *extra_arguments)
    )
    return actions.with_call_location(element, value)


def _extra_arguments(actions: ActionTranslator, value: av.Value) -> Iterator[Element]:
    for item in av.items_of(value)[0]:
        if isinstance(item, av.MapValue):
            yield from entry_elements(actions.translator, item, "extra_arg")


def _remaps_and_parameters(actions: ActionTranslator, fields: Fields) -> tuple[Element, ...]:
    return (
        *actions.pair_elements("remap", fields.get("remappings"), "from", "to"),
        *parameter_elements(actions.translator, fields.get("parameters")),
    )


def _renamed(fields: Fields) -> Fields:
    return {_RENAMED_FIELDS.get(key, key): value for key, value in fields.items()}


_EVENT_FIELDS = ("on_exit", "on_start", "on_completion", "on_shutdown", "on_stdin", "on_stdout")
_ACTION_FIELDS = frozenset({*_EVENT_FIELDS, "on_stderr", "on_event", "entities", "handler"})
"""The parameters of event handlers that have actions."""


def _text_element(tag: str, **keys: str) -> Build:
    """Return what makes an element of texts only."""
    return lambda actions, fields: Element(tag, actions.attributes_of(fields, **keys))


def _same_named(tag: str, *keys: str) -> Build:
    """Return what makes an element whose attributes are called like the parameters."""
    return _text_element(tag, **{key: key for key in keys})


def _empty_element(tag: str) -> Build:
    return lambda actions, fields: Element(tag, {})


def _group(actions: ActionTranslator, fields: Fields) -> Element:
    flags: Attributes = {
        key: "false" for key in ("scoped", "forwarding") if is_false(fields.get(key))
    }
    preserved_elements = actions.pair_elements(
        "keep", fields.get("launch_configurations"), "name", "value"
    )
    return Element(
        "group", flags, (*preserved_elements, *actions.elements(fields.get("actions", av.NONE)))
    )


def _include(actions: ActionTranslator, fields: Fields) -> Element:
    file = actions.translator.template(fields.get("launch_description_source"))
    arguments = actions.pair_elements("arg", fields.get("launch_arguments"), "name", "value")
    return Element("include", {"file": file}, arguments)


def _argument(actions: ActionTranslator, fields: Fields) -> Element:
    attributes = actions.attributes_of(fields, name="name", default="default_value")
    attributes["description"] = plain_text(fields.get("description"))
    return Element("arg", attributes)


def _set_parameter(actions: ActionTranslator, fields: Fields) -> Element:
    """Return the element of a parameter for all nodes."""
    name = actions.translator.template(fields.get("name"))
    return parameter_element(
        actions.translator, name, fields.get("value", av.NONE), "set_parameter"
    )


def _timer(actions: ActionTranslator, fields: Fields) -> Element:
    attributes = actions.attributes_of(fields, period="period")
    return Element("timer", attributes, actions.elements(fields.get("actions", av.NONE)))


def _event_handler(actions: ActionTranslator, fields: Fields) -> Element:
    handler = fields.get("event_handler", av.NONE)
    name = launch_class_name(handler)
    if not isinstance(handler, av.Instance) or not name:
        return Element("unknown_handler", {})
    handler_values = [
        value for key, value in constructor_arguments(handler).items() if key in _ACTION_FIELDS
    ]
    inner = [
        child for value in handler_values for child in actions.event_element(name, value).children
    ]
    return Element("event_handler", {"event": name}, tuple(inner))


def _event(actions: ActionTranslator, fields: Fields) -> Element:
    """Return the element of an event: of one that is known, only `ChangeState` changes a state."""
    event = fields.get("event", av.NONE)
    if launch_class_name(event) not in {"", "ChangeState"}:
        return Element("log", {})
    matcher = _made_with(event).get("lifecycle_node_matcher", av.NONE)
    node = _made_with(_made_with(matcher).get("target_action", av.NONE))
    names = {**actions.attributes_of(node, node="name")}
    names |= actions.attributes_of(_made_with(matcher), node="node_name")
    return Element("lifecycle_transition", names)


def _made_with(value: av.Value) -> Fields:
    return constructor_arguments(value) if isinstance(value, av.Instance) else {}


def _opaque_function(actions: ActionTranslator, fields: Fields) -> Element:
    return actions.function_element(
        actions.callbacks.callback(fields, actions.elements, event=False)
    )


def _loop(actions: ActionTranslator, fields: Fields) -> Element:
    return actions.function_element(actions.callbacks.loop_callback(fields, actions.elements))


def _process(actions: ActionTranslator, fields: Fields) -> Element:
    description = fields.get("process_description", av.NONE)
    process_fields = (
        constructor_arguments(description) if isinstance(description, av.Instance) else fields
    )
    environ = (
        *actions.pair_elements("env", process_fields.get("env"), "name", "value"),
        *actions.pair_elements("env", process_fields.get("additional_env"), "name", "value"),
    )
    shell = {"shell": "true"} if av.truth(fields.get("shell", av.NONE)) is True else {}
    attributes = {**actions.attributes_of(process_fields, name="name"), **shell}
    return Element(
        "executable",
        attributes,
        (*actions.word_elements("cmd", process_fields.get("cmd")), *environ),
    )


def _replace_environment(actions: ActionTranslator, fields: Fields) -> Element:
    return Element(
        "rep_env", {}, actions.pair_elements("env", fields.get("environment"), "name", "value")
    )


def _reset(actions: ActionTranslator, fields: Fields) -> Element:
    preserved_elements = actions.pair_elements(
        "keep", fields.get("launch_configurations"), "name", "value"
    )
    return Element("reset", {}, preserved_elements)


_IGNORED_ACTIONS = (
    "Log",
    "LogDebug",
    "LogError",
    "LogInfo",
    "LogWarning",
    "ReadyToTest",
    "SetROSLogDir",
    "SetUseSimTime",
    "Shutdown",
    "UnregisterEventHandler",
)
_APPEND_FIELDS = {"name": "name", "value": "value", "prepend": "prepend", "separator": "separator"}
_COMPOSITION_FIELDS = ("container_name", "create_own_container", "use_composition")
BUILDERS: Mapping[str, Build] = {
    **dict.fromkeys(_IGNORED_ACTIONS, _empty_element("log")),
    "LifecycleTransition": _empty_element("lifecycle_transition"),
    "AppendEnvironmentVariable": _text_element("append_env", **_APPEND_FIELDS),
    "ComposableNodeContainer": partial(node_element, tag="node_container"),
    "DeclareBooleanLaunchArgument": _argument,
    "DeclareLaunchArgument": _argument,
    "EmitEvent": _event,
    "ExecuteLocal": _process,
    "ExecuteProcess": _process,
    "ForEach": _loop,
    "ForLoop": _loop,
    "GroupAction": _group,
    "GzServer": _same_named(
        "gz_server", "world_sdf_file", "world_sdf_string", *_COMPOSITION_FIELDS
    ),
    "GzSpawnModel": _same_named("gz_spawn_model", "file", "model_string", "topic", "entity_name"),
    "IncludeLaunchDescription": _include,
    "LifecycleNode": partial(node_element, tag="lifecycle_node"),
    "LoadComposableNodes": load_element,
    "Node": partial(node_element, tag="node"),
    "OpaqueCoroutine": _opaque_function,
    "OpaqueFunction": _opaque_function,
    "PopLaunchConfigurations": _empty_element("pop_vars"),
    "PushLaunchConfigurations": _empty_element("push_vars"),
    "PushROSNamespace": _text_element("push_ros_namespace", namespace="namespace"),
    "PushRosNamespace": _text_element("push_ros_namespace", namespace="namespace"),
    "RegisterEventHandler": _event_handler,
    "ReplaceEnvironmentVariables": _replace_environment,
    "ResetEnvironment": _empty_element("reset_env"),
    "ResetLaunchConfigurations": _reset,
    "ROSTimer": _timer,
    "RosGzBridge": _same_named(
        "ros_gz_bridge", "bridge_name", "namespace", "config_file", *_COMPOSITION_FIELDS
    ),
    "RosTimer": _timer,
    "SetEnvironmentVariable": _text_element("set_env", name="name", value="value"),
    "SetLaunchConfiguration": _text_element("let", name="name", value="value"),
    "SetParameter": _set_parameter,
    "SetParametersFromFile": _text_element("set_parameters_from_file", filename="filename"),
    "SetRemap": _text_element("set_remap", **{"from": "src", "to": "dst"}),
    "TimerAction": _timer,
    "UnsetEnvironmentVariable": _text_element("unset_env", name="name"),
    "UnsetLaunchConfiguration": _text_element("unset", name="name"),
}

"""The element that each class of actions becomes (launch.actions, launch_ros.actions)."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import NONE, Instance, truth
from rtron.sources.code.library_models.launch.constructor_calls import call_name, given
from rtron.sources.launch.ros2.python.actions import Actions, Attributes, Build
from rtron.sources.launch.ros2.python.nodes import load, node
from rtron.sources.launch.ros2.python.parameters import parameter
from rtron.sources.launch.ros2.python.substitutions import Fields, plain_text, says_no
from rtron.sources.launch.ros2.xml_yaml.element import Element

_ON = ("on_exit", "on_start", "on_completion", "on_shutdown", "on_stdin", "on_stdout")
_EVENTS = frozenset({*_ON, "on_stderr", "on_event", "entities", "handler"})
"""The parameters of event handlers that have actions."""


def _plain(tag: str, **keys: str) -> Build:
    """Return what makes an element of texts only."""
    return lambda actions, fields: Element(tag, actions.texts_of(fields, **keys))


def _same(tag: str, *keys: str) -> Build:
    """Return what makes an element whose attributes are called like the parameters."""
    return _plain(tag, **{key: key for key in keys})


def _named(tag: str) -> Build:
    return lambda actions, fields: Element(tag, {})


def _group(actions: Actions, fields: Fields) -> Element:
    flags: Attributes = {
        key: "false" for key in ("scoped", "forwarding") if says_no(fields.get(key))
    }
    keep = actions.pairs("keep", fields.get("launch_configurations"), "name", "value")
    return Element("group", flags, (*keep, *actions.elements(fields.get("actions", NONE))))


def _include(actions: Actions, fields: Fields) -> Element:
    file = actions.texts.pieces(fields.get("launch_description_source"))
    arguments = actions.pairs("arg", fields.get("launch_arguments"), "name", "value")
    return Element("include", {"file": file}, arguments)


def _argument(actions: Actions, fields: Fields) -> Element:
    attributes = actions.texts_of(fields, name="name", default="default_value")
    attributes["description"] = plain_text(fields.get("description"))
    return Element("arg", attributes)


def _shared(actions: Actions, fields: Fields) -> Element:
    """Return the element of a parameter for all nodes."""
    name = actions.texts.pieces(fields.get("name"))
    return parameter(actions.texts, name, fields.get("value", NONE), "set_parameter")


def _timer(actions: Actions, fields: Fields) -> Element:
    attributes = actions.texts_of(fields, period="period")
    return Element("timer", attributes, actions.elements(fields.get("actions", NONE)))


def _handler(actions: Actions, fields: Fields) -> Element:
    handler = fields.get("event_handler", NONE)
    name = call_name(handler)
    if not isinstance(handler, Instance) or not name:
        return Element("unknown_handler", {})
    found = [value for key, value in given(handler).items() if key in _EVENTS]
    inner = [child for value in found for child in actions.event(name, value).children]
    return Element("event_handler", {"event": name}, tuple(inner))


def _function(actions: Actions, fields: Fields) -> Element:
    called = actions.functions.called(fields, actions.elements, event=False)
    return Element("function", {}, run=called)


def _loop(actions: Actions, fields: Fields) -> Element:
    return Element("function", {}, run=actions.functions.looped(fields, actions.elements))


def _process(actions: Actions, fields: Fields) -> Element:
    description = fields.get("process_description", NONE)
    own = given(description) if isinstance(description, Instance) else fields
    environ = (
        *actions.pairs("env", own.get("env"), "name", "value"),
        *actions.pairs("env", own.get("additional_env"), "name", "value"),
    )
    shell = {"shell": "true"} if truth(fields.get("shell", NONE)) is True else {}
    attributes = {**actions.texts_of(own, name="name"), **shell}
    return Element("executable", attributes, (*actions.words("cmd", own.get("cmd")), *environ))


def _reset(actions: Actions, fields: Fields) -> Element:
    kept = actions.pairs("keep", fields.get("launch_configurations"), "name", "value")
    return Element("reset", {}, kept)


_SILENT = (
    "EmitEvent",
    "LifecycleTransition",
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
_APPEND = {"name": "name", "value": "value", "prepend": "prepend", "separator": "separator"}
_COMPOSED = ("container_name", "create_own_container", "use_composition")
BUILDERS: Mapping[str, Build] = {
    **dict.fromkeys(_SILENT, _named("log")),
    "AppendEnvironmentVariable": _plain("append_env", **_APPEND),
    "ComposableNodeContainer": partial(node, tag="node_container"),
    "DeclareLaunchArgument": _argument,
    "ExecuteLocal": _process,
    "ExecuteProcess": _process,
    "ForEach": _loop,
    "ForLoop": _loop,
    "GroupAction": _group,
    "GzServer": _same("gz_server", "world_sdf_file", "world_sdf_string", *_COMPOSED),
    "GzSpawnModel": _same("gz_spawn_model", "file", "model_string", "topic", "entity_name"),
    "IncludeLaunchDescription": _include,
    "LifecycleNode": partial(node, tag="lifecycle_node"),
    "LoadComposableNodes": load,
    "Node": partial(node, tag="node"),
    "OpaqueCoroutine": _function,
    "OpaqueFunction": _function,
    "PushROSNamespace": _plain("push_ros_namespace", namespace="namespace"),
    "PushRosNamespace": _plain("push_ros_namespace", namespace="namespace"),
    "RegisterEventHandler": _handler,
    "ResetEnvironment": _named("reset_env"),
    "ResetLaunchConfigurations": _reset,
    "ROSTimer": _timer,
    "RosGzBridge": _same("ros_gz_bridge", "bridge_name", "namespace", "config_file", *_COMPOSED),
    "RosTimer": _timer,
    "SetEnvironmentVariable": _plain("set_env", name="name", value="value"),
    "SetLaunchConfiguration": _plain("let", name="name", value="value"),
    "SetParameter": _shared,
    "SetParametersFromFile": _plain("set_parameters_from_file", filename="filename"),
    "SetRemap": _plain("set_remap", **{"from": "src", "to": "dst"}),
    "TimerAction": _timer,
    "UnsetEnvironmentVariable": _plain("unset_env", name="name"),
    "UnsetLaunchConfiguration": _plain("unset", name="name"),
}

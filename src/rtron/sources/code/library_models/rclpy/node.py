"""rclpy's nodes (docs.ros.org: rclpy.node)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    Foreign,
    Hole,
    Instance,
    Known,
    MessageType,
    NativeClass,
    Value,
    options,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclpy.parameters import PARAMETER_METHODS, parameter
from rtron.sources.code.library_models.rclpy.qos import quality
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import (
    GLOBALLY,
    NAME,
    SUB,
    NodeWords,
    base_at,
    full_name,
    name_of,
    namespace_at,
    node_among,
    own_settings,
    resolved,
)
from rtron.sources.code.library_models.ros2_common.parameters import AUTOMATIC, OVERRIDES
from rtron.sources.code.library_models.ros2_common.qos_overrides import Overridable
from rtron.sources.declaration import DeclarationKind

_UNKNOWN = Hole("?")
_MODULE_PARTS = 3
_ASKED = {
    "parameter_services": ("start_parameter_services", TRUE),
    "rosout": ("enable_rosout", TRUE),
    "parameter_events": ("parameter_events", TRUE),
    "logger_service": ("enable_logger_service", FALSE),
}
"""The arguments that tell whether a node has these, and their defaults; events it always has."""

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def type_name(value: Value | None) -> str:
    """Return a message, service or action class as the graph has it; empty where not known."""
    for option in options(value):
        if isinstance(option, MessageType):
            return option.name
        dotted = option.name.split(".") if isinstance(option, Foreign) else []
        parts = [part for part in dotted if not part.startswith("_")]
        if len(parts) == _MODULE_PARTS and parts[1] in {"msg", "srv", "action"}:
            return "/".join(parts)
    return ""


def escape_all(machine: Machine, arguments: Arguments) -> None:
    """Remember every function among the arguments."""
    for value in (*arguments.values, *arguments.keywords.values()):
        machine.escape(value)


def initialise(
    machine: Machine, owner: Instance, arguments: Arguments, *, lifecycle: bool = False
) -> Value:
    """`Node.__init__(name, *, namespace, cli_args, use_global_arguments, …)`."""
    given = arguments.keywords
    words = NodeWords(
        name=arguments.get(0, "node_name") or Hole("node_name"),
        namespace=_text(given.get("namespace")),
        arguments=given.get("cli_args", NONE),
        globally=truth(given.get("use_global_arguments", Known(value=True))) is not False,
    )
    automatic = given.get("automatically_declare_parameters_from_overrides", FALSE)
    for field, value in (
        (NAME, full_name(machine, words)),
        (SUB, Known("")),
        (GLOBALLY, Known(words.globally)),
        (OVERRIDES, _overrides(words, given.get("parameter_overrides", NONE))),
        (AUTOMATIC, automatic),
    ):
        machine.trail.set(owner.fields, field, value)

    def asked(option: str) -> bool:
        name, default = _ASKED.get(option, ("", FALSE))
        return truth(given.get(name, default)) is not False

    endpoints.join_app(machine, owner, words, arguments, asked)
    if lifecycle:
        endpoints.lifecycle(machine, owner, arguments)
    return NONE


def _overrides(words: NodeWords, given: Value) -> Value:
    """Return the parameters that a node is made with: those given count over its arguments'."""
    pairs = own_settings(words.arguments)
    own = tuple(parameter(Known(name), value) for name, value in pairs)
    return listed((*own, *items_of(given)[0])) if own else given


def _text(value: Value | None) -> Value:
    return Known("") if value is None or value == NONE else value


def make_node(machine: Machine, arguments: Arguments) -> Instance:
    """`Node("name")`, `rclpy.create_node("name")`."""
    made = Instance(NODE)
    initialise(machine, made, arguments)
    return made


def _make_lifecycle_node(machine: Machine, arguments: Arguments) -> Instance:
    made = Instance(LIFECYCLE_NODE)
    initialise(machine, made, arguments, lifecycle=True)
    return made


def declare(
    kind: DeclarationKind, machine: Machine, node: Value | None, arguments: Arguments, at: int
) -> Value:
    """Record what is made of a type and a name, which are the arguments from `at` on."""
    escape_all(machine, arguments)
    type = type_name(arguments.get(at, _TYPES[kind]) or arguments.keywords.get("type"))
    name = arguments.get(at + 1, _NAMES[kind])
    owner = node_among((node,)) if node is not None else None
    if owner is None:
        endpoints.unknown_owner(machine, kind.value, name, arguments)
        return Hole(kind.value)
    given = arguments.keywords.get("qos_overriding_options")
    overridable = Overridable(machine, kind, owner, arguments)
    qos = overridable.qos(resolved(owner, name), quality(kind, arguments, at), given)
    full = endpoints.declare(machine, kind, owner, name, type, arguments, qos=qos)
    return Instance(ENDPOINT, dict.fromkeys(("topic_name", "topic", "srv_name"), full))


_TYPES = {
    _PUBLISH: "msg_type",
    _SUBSCRIBE: "msg_type",
    DeclarationKind.SERVICE: "srv_type",
    DeclarationKind.SERVICE_CLIENT: "srv_type",
    DeclarationKind.ACTION_SERVER: "action_type",
    DeclarationKind.ACTION_CLIENT: "action_type",
}
_NAMES = {
    _PUBLISH: "topic",
    _SUBSCRIBE: "topic",
    DeclarationKind.SERVICE: "srv_name",
    DeclarationKind.SERVICE_CLIENT: "srv_name",
    DeclarationKind.ACTION_SERVER: "action_name",
    DeclarationKind.ACTION_CLIENT: "action_name",
}


def _create(kind: DeclarationKind, machine: Machine, owner: Value, arguments: Arguments) -> Value:
    return declare(kind, machine, owner, arguments, 0)


def _callback(machine: Machine, _: Value, arguments: Arguments) -> Value:
    escape_all(machine, arguments)
    return Instance(ENDPOINT)


def _resolve(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    del machine
    return resolved(owner, arguments.get(0, "topic") or arguments.get(0, "service"))


_METHODS: Mapping[str, Callable[..., Value]] = {
    **PARAMETER_METHODS,
    "__init__": initialise,
    **dict.fromkeys(("create_publisher", "create_lifecycle_publisher"), partial(_create, _PUBLISH)),
    "create_subscription": partial(_create, _SUBSCRIBE),
    "create_service": partial(_create, DeclarationKind.SERVICE),
    "create_client": partial(_create, DeclarationKind.SERVICE_CLIENT),
    **dict.fromkeys(("create_timer", "create_guard_condition", "create_task"), _callback),
    **dict.fromkeys(("resolve_topic_name", "resolve_service_name"), _resolve),
    "get_name": lambda machine, owner, arguments: base_at(owner),
    "get_namespace": lambda machine, owner, arguments: namespace_at(owner),
    "get_fully_qualified_name": lambda machine, owner, arguments: name_of(owner),
}
ENDPOINT = NativeClass(
    "rclpy.endpoint",
    methods=dict.fromkeys(
        (
            *("registerCallback", "add_done_callback", "send_goal_async", "call_async", "add"),
            *("register_handle_accepted_callback", "register_execute_callback"),
            "register_goal_callback",
        ),
        _callback,
    ),
)
NODE = NativeClass("rclpy.node.Node", make_node, dict(_METHODS))
LIFECYCLE_NODE = NativeClass(
    "rclpy.lifecycle.LifecycleNode",
    _make_lifecycle_node,
    {**_METHODS, "__init__": partial(initialise, lifecycle=True)},
    called=("on_configure", "on_activate", "on_deactivate", "on_cleanup", "on_shutdown"),
)

"""rclpy's nodes and their parameters (docs.ros.org: rclpy.node, rclpy.parameter)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.rclpy.qos import endpoint_qos
from rtron.sources.code.library_models.ros2_common import endpoints, nodes, parameters
from rtron.sources.code.library_models.ros2_common.mistyped_parameters import record_mistyped
from rtron.sources.code.library_models.ros2_common.parameter_types import (
    python_parameter_type,
    type_name,
)
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC_FIELD,
    OVERRIDES_FIELD,
)
from rtron.sources.code.library_models.ros2_common.qos import QosOverrides
from rtron.sources.declaration import DeclarationKind

_VALUES = (
    *("string_value", "integer_value", "double_value", "bool_value", "string_array_value"),
    *("integer_array_value", "double_array_value", "bool_array_value", "byte_array_value"),
)


def parameter_object(name: av.Value, value: av.Value) -> av.Instance:
    """Return an rclpy.parameter.Parameter."""
    return av.Instance(PARAMETER, {"name": name, "value": value, "type_": av.Unknown("type_")})


def _declare_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameter(name, value)`; a type instead of the value is no default."""
    name = arguments.value(0, "name")
    default = _declared_default(arguments.get(1, "value"))
    record_mistyped(machine, owner, arguments, type_name(default))
    return parameter_object(name, parameters.declare_node_parameter(machine, owner, name, default))


def _declared_default(value: av.Value | None) -> av.Value | None:
    kind = python_parameter_type(value)
    if kind is not None:
        return kind
    is_open = (
        value is None or value == av.NONE or isinstance(value, (av.ExternalSymbol, av.Instance))
    )
    return None if is_open else value


def _declare_all(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`declare_parameters(namespace, [(name, value), …])`."""
    space, given = arguments.get(0, "namespace"), arguments.get(1, "parameters")
    flag = arguments.get(2, "ignore_override")
    items, certain = av.items_of(given or av.NONE)
    found: list[av.Value] = []
    for item in items:
        words = av.items_of(item)[0]
        name, value = (*words, av.UNKNOWN, None)[:2]
        full = parameters.prefixed_name(space, name or av.UNKNOWN)
        default = _declared_default(value)
        call = arguments.with_values(full, *words[1:], *(() if flag is None else (flag,)))
        record_mistyped(machine, owner, call, type_name(default))
        declared = parameters.declare_node_parameter(machine, owner, full, default)
        found.append(parameter_object(full, declared))
    return av.list_of(found, certain=certain)


def _get_parameter(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter(name)`."""
    name = arguments.value(0, "name")
    return parameter_object(name, parameters.read_node_parameter(machine, owner, name))


def _get_parameter_or(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameter_or(name, alternative)`."""
    name = arguments.value(0, "name")
    default = parameters.unwrap_parameter(arguments.get(1, "alternative_value")) or av.NONE
    found = parameters.node_parameter_value(machine, owner, name)
    return parameter_object(name, parameters.value_or_default(found, default))


def _get_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters([name, …])`."""
    names, _ = av.items_of(arguments.get(0, "names") or av.NONE)
    return av.list_of([_get_parameter(machine, owner, arguments.with_values(n)) for n in names])


def _get_by_prefix(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`get_parameters_by_prefix(prefix)`: what the launch sets below a prefix, and maybe others."""
    prefix = arguments.get(0, "prefix")
    if not isinstance(prefix, av.Scalar):
        return av.MapValue({av.OPEN: av.Unknown("parameter", tainted=True)})
    names, certain = parameters.parameter_names(machine, owner)
    found: dict[object, av.Value] = {}
    for name, rest in parameters.names_below(names, str(prefix.value)).items():
        value = parameters.node_parameter_value(machine, owner, av.Scalar(name)) or av.UNKNOWN
        found[rest] = parameter_object(av.Scalar(name), value)
    if not certain:
        found[av.OPEN] = parameter_object(
            av.UNKNOWN, av.Unknown(f"~{prefix.value}.*", tainted=True)
        )
    return av.MapValue(found)


def _add_callback(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    parameters.note_parameter_callbacks(machine, arguments)
    machine.escape(arguments.get(0, "callback"))
    return av.NONE


def _make_parameter(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`Parameter(name, type, value)`."""
    value = arguments.get(2, "value") or av.NONE
    return parameter_object(arguments.value(0, "name"), value)


def _parameter_value_message(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    """`get_parameter_value()`: a message with a field for each type."""
    return av.Instance(_MESSAGE, dict.fromkeys(_VALUES, owner.fields["value"]))


_MESSAGE = av.LibraryClass("rcl_interfaces/ParameterValue")
PARAMETER = av.LibraryClass(
    "rclpy.parameter.Parameter", _make_parameter, {"get_parameter_value": _parameter_value_message}
)
PARAMETER_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **parameters.PARAMETER_METHODS,
    "declare_parameter": _declare_parameter,
    "declare_parameters": _declare_all,
    "get_parameter": _get_parameter,
    "get_parameter_or": _get_parameter_or,
    "get_parameters": _get_parameters,
    "get_parameters_by_prefix": _get_by_prefix,
    **dict.fromkeys(parameters.PARAMETER_CALLBACKS, _add_callback),
}


_MODULE_PARTS = 3
_OPTIONS = {
    **dict.fromkeys(("start_parameter_services", "enable_rosout"), av.TRUE),
    "start_parameter_event_publisher": av.TRUE,
    "enable_logger_service": av.FALSE,
}
"""The options of a node, and their defaults; in rclpy it always publishes parameter events."""

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def interface_name(value: av.Value | None) -> str:
    """Return a message, service or action class as the graph has it; empty where not known."""
    for option in av.options(value):
        if isinstance(option, av.MessageType):
            return option.name
        dotted = option.name.split(".") if isinstance(option, av.ExternalSymbol) else []
        parts = [part for part in dotted if not part.startswith("_")]
        if len(parts) == _MODULE_PARTS and parts[1] in {"msg", "srv", "action"}:
            return "/".join(parts)
    return ""


def initialise_node(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments, *, lifecycle: bool = False
) -> av.Value:
    """`Node.__init__(name, *, namespace, cli_args, use_global_arguments, …)`."""
    given = arguments.keywords
    words = nodes.NodeArguments(
        name=arguments.get(0, "node_name") or av.Unknown("node_name"),
        namespace=_text_or_empty(given.get("namespace")),
        arguments=given.get("cli_args", av.NONE),
        uses_global_arguments=av.truth(given.get("use_global_arguments", av.Scalar(value=True)))
        is not False,
    )
    automatic = given.get("automatically_declare_parameters_from_overrides", av.FALSE)
    for field, value in (
        (nodes.NAME_FIELD, nodes.full_name(machine, words)),
        (nodes.GLOBAL_ARGUMENTS_FIELD, av.Scalar(words.uses_global_arguments)),
        (OVERRIDES_FIELD, _parameter_overrides(words, given.get("parameter_overrides", av.NONE))),
        (AUTOMATIC_FIELD, automatic),
    ):
        machine.undo_log.set(owner.fields, field, value)

    def is_enabled(option: str) -> bool:
        return av.truth(given.get(option, _OPTIONS.get(option, av.FALSE))) is not False

    endpoints.declare_node(machine, owner, words, arguments, is_enabled)
    if lifecycle:
        endpoints.declare_lifecycle(machine, owner, arguments)
    return av.NONE


def _parameter_overrides(words: nodes.NodeArguments, given: av.Value) -> av.Value:
    """Return the parameters that a node is made with: those given count over its arguments'."""
    pairs = nodes.own_parameters(words.arguments)
    own = tuple(parameter_object(av.Scalar(name), value) for name, value in pairs)
    return av.list_of((*own, *av.items_of(given)[0])) if own else given


def _text_or_empty(value: av.Value | None) -> av.Value:
    return av.Scalar("") if value is None or value == av.NONE else value


def make_node(machine: AbstractMachine, arguments: Arguments) -> av.Instance:
    """`Node("name")`, `rclpy.create_node("name")`."""
    made = av.Instance(NODE)
    initialise_node(machine, made, arguments)
    return made


def _make_lifecycle_node(machine: AbstractMachine, arguments: Arguments) -> av.Instance:
    made = av.Instance(LIFECYCLE_NODE)
    initialise_node(machine, made, arguments, lifecycle=True)
    return made


def declare_endpoint(
    kind: DeclarationKind,
    machine: AbstractMachine,
    node: av.Value | None,
    arguments: Arguments,
    at: int,
) -> av.Value:
    """Record what is made of a type and a name, which are the arguments from `at` on."""
    machine.escape_arguments(arguments)
    type = interface_name(arguments.get(at, _TYPE_KEYWORDS[kind]) or arguments.keywords.get("type"))
    name = arguments.get(at + 1, _NAME_KEYWORDS[kind])
    owner = nodes.first_node((node,)) if node is not None else None
    if owner is None:
        endpoints.note_unknown_node(machine, kind.value, name, arguments)
        return av.Unknown(kind.value)
    given = arguments.keywords.get("qos_overriding_options")
    overridable = QosOverrides(machine, kind, owner, arguments)
    qos = overridable.effective_qos(
        nodes.resolve_at_node(owner, name), endpoint_qos(kind, arguments, at), given
    )
    full = endpoints.declare_endpoint(machine, kind, owner, name, type, arguments, qos=qos)
    return av.Instance(ENDPOINT, dict.fromkeys(("topic_name", "topic", "srv_name"), full))


_TYPE_KEYWORDS = {
    _PUBLISH: "msg_type",
    _SUBSCRIBE: "msg_type",
    DeclarationKind.SERVICE: "srv_type",
    DeclarationKind.SERVICE_CLIENT: "srv_type",
    DeclarationKind.ACTION_SERVER: "action_type",
    DeclarationKind.ACTION_CLIENT: "action_type",
}
_NAME_KEYWORDS = {
    _PUBLISH: "topic",
    _SUBSCRIBE: "topic",
    DeclarationKind.SERVICE: "srv_name",
    DeclarationKind.SERVICE_CLIENT: "srv_name",
    DeclarationKind.ACTION_SERVER: "action_name",
    DeclarationKind.ACTION_CLIENT: "action_name",
}


def _create_endpoint(
    kind: DeclarationKind, machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    return declare_endpoint(kind, machine, owner, arguments, 0)


def _register_callback(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    machine.escape_arguments(arguments)
    return av.Instance(ENDPOINT)


def _resolve_name(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    del machine
    return nodes.resolve_at_node(owner, arguments.get(0, "topic") or arguments.get(0, "service"))


_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **PARAMETER_METHODS,
    "__init__": initialise_node,
    **dict.fromkeys(
        ("create_publisher", "create_lifecycle_publisher"), partial(_create_endpoint, _PUBLISH)
    ),
    "create_subscription": partial(_create_endpoint, _SUBSCRIBE),
    "create_service": partial(_create_endpoint, DeclarationKind.SERVICE),
    "create_client": partial(_create_endpoint, DeclarationKind.SERVICE_CLIENT),
    **dict.fromkeys(("create_timer", "create_guard_condition", "create_task"), _register_callback),
    **dict.fromkeys(("resolve_topic_name", "resolve_service_name"), _resolve_name),
    "get_name": lambda machine, owner, arguments: nodes.node_base_name(owner),
    "get_namespace": lambda machine, owner, arguments: nodes.node_namespace(owner),
    "get_fully_qualified_name": lambda machine, owner, arguments: nodes.node_name(owner),
}
ENDPOINT = av.LibraryClass(
    "rclpy.endpoint",
    methods=dict.fromkeys(
        (
            *("registerCallback", "add_done_callback", "send_goal_async", "call_async", "add"),
            *("register_handle_accepted_callback", "register_execute_callback"),
            "register_goal_callback",
        ),
        _register_callback,
    ),
)
NODE = av.LibraryClass("rclpy.node.Node", make_node, dict(_METHODS))
LIFECYCLE_NODE = av.LibraryClass(
    "rclpy.lifecycle.LifecycleNode",
    _make_lifecycle_node,
    {
        **_METHODS,
        "__init__": partial(initialise_node, lifecycle=True),
        **dict.fromkeys(("trigger_configure", "trigger_activate"), endpoints.change_own_state),
    },
    virtual_callbacks=("on_configure", "on_activate", "on_deactivate", "on_cleanup", "on_shutdown"),
)

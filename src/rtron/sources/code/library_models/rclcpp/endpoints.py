"""What rclcpp's nodes publish, subscribe, serve and call, and rclcpp_action's actions."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    TRUE,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    is_text,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    callback_message,
    escape_all,
    take_callbacks,
    typed,
)
from rtron.sources.code.library_models.rclcpp.qos_overrides import options_among
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.nodes import is_node, node_among, resolved
from rtron.sources.code.library_models.ros2_common.qos import is_qos, qos_of
from rtron.sources.code.library_models.ros2_common.qos_overrides import Overridable
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

_UNKNOWN = Hole("?")
_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_REQUEST = ("::Request", "_Request", "Request")


def owned(owner: Value, arguments: Arguments) -> tuple[Instance | None, Arguments]:
    """Return the node of a call, and the arguments behind it or its interfaces."""
    if isinstance(owner, Instance) and is_node(owner):
        return owner, arguments
    count = 0
    while count < len(arguments.values) and node_among(arguments.values[count : count + 1]):
        count += 1
    return node_among(arguments.values), arguments.shifted(max(count, 1))


def endpoint(kind: DeclarationKind, machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`create_publisher<T>(topic, qos)`, `create_service<T>(name, callback)` and their kin.

    As methods of a node, or as functions that take it, or its interfaces, first.
    """
    node, rest = owned(owner, arguments)
    type = typed(machine, rest) or callback_message(machine, rest, 1)
    return _made(kind, machine, node, type, rest)


def generic(kind: DeclarationKind, machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`create_generic_publisher(topic, type, qos)`."""
    node, rest = owned(owner, arguments)
    type = rest.get(1)
    written = str(type.value) if isinstance(type, Known) and is_text(type) else ""
    return _made(kind, machine, node, written, rest)


def _made(
    kind: DeclarationKind, machine: Machine, node: Value | None, type: str, rest: Arguments
) -> Value:
    escape_all(machine, rest)
    name = rest.get(0)
    if node is None:
        endpoints.unknown_owner(machine, kind.value, name, rest)
        return Hole(kind.value)
    plain = type
    for ending in _REQUEST:
        plain = plain.removesuffix(ending)
    overridable = Overridable(machine, kind, node, rest)
    qos = overridable.qos(resolved(node, name), _quality(kind, rest), options_among(rest))
    full = endpoints.declare(machine, kind, node, name, plain, rest, qos=qos)
    return Instance(ENDPOINT, {"name": full, "truth": TRUE})


def _quality(kind: DeclarationKind, rest: Arguments) -> QoS | None:
    if kind not in {_PUBLISH, _SUBSCRIBE}:
        return None
    return qos_of(given_qos(rest))


def given_qos(rest: Arguments) -> Value | None:
    """Return the quality of service, or the depth, that stands behind a topic."""
    return next((v for v in rest.values[1:] if is_qos(v) or _is_depth(v)), None)


def _is_depth(value: Value) -> bool:
    number = value.value if isinstance(value, Known) else None
    return isinstance(number, int) and not isinstance(number, bool)


def timer(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`create_wall_timer(period, callback)`."""
    del owner
    escape_all(machine, arguments)
    return Instance(_TIMER, {"truth": TRUE})


def _wait_for_message(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`rclcpp::wait_for_message(message, node, topic)`: the message's type is not looked at."""
    del owner
    node, rest = owned(NONE_OWNER, arguments.shifted(1))
    _made(_SUBSCRIBE, machine, node, typed(machine, arguments), rest)
    return Hole("wait_for_message")


def _topic(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields.get("name", _UNKNOWN)


def _itself(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner


NONE_OWNER = Known(None)
ENDPOINT = NativeClass(
    "rclcpp::Publisher",
    methods={
        **dict.fromkeys(("get_topic_name", "get_service_name"), _topic),
        **dict.fromkeys(
            ("async_send_request", "async_send_goal", "async_cancel_goal"), take_callbacks
        ),
        "shared_from_this": _itself,
    },
)
_TIMER = NativeClass("rclcpp::Timer")
_CALLS: Mapping[str, Callable[..., Value]] = {
    "create_publisher": partial(endpoint, _PUBLISH),
    "create_subscription": partial(endpoint, _SUBSCRIBE),
    "create_service": partial(endpoint, DeclarationKind.SERVICE),
    "create_client": partial(endpoint, DeclarationKind.SERVICE_CLIENT),
    "create_generic_publisher": partial(generic, _PUBLISH),
    "create_generic_subscription": partial(generic, _SUBSCRIBE),
    "create_generic_client": partial(generic, DeclarationKind.SERVICE_CLIENT),
    "create_generic_service": partial(generic, DeclarationKind.SERVICE),
    **dict.fromkeys(("create_wall_timer", "create_timer"), timer),
}
ENDPOINT_METHODS = _CALLS
ENDPOINT_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    **{f"rclcpp::{name}": call for name, call in _CALLS.items()},
    "rclcpp::wait_for_message": _wait_for_message,
    "rclcpp_action::create_server": partial(endpoint, DeclarationKind.ACTION_SERVER),
    "rclcpp_action::create_client": partial(endpoint, DeclarationKind.ACTION_CLIENT),
}

"""What rclcpp's nodes publish, subscribe, serve and call, and rclcpp_action's actions."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    callback_message_type,
    escape_functions,
    register_callbacks,
    template_message_type,
)
from rtron.sources.code.library_models.common.trivial_functions import (
    return_owner,
    returning_field,
    returning_unknown,
)
from rtron.sources.code.library_models.rclcpp.qos import overriding_options_argument
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.names import expand_name
from rtron.sources.code.library_models.ros2_common.nodes import (
    first_node,
    is_node,
    node_name,
    resolve_at_node,
)
from rtron.sources.code.library_models.ros2_common.qos import QosOverrides, is_qos, read_qos
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_REQUEST_SUFFIXES = ("::Request", "_Request", "Request")


def split_node(owner: av.Value, arguments: Arguments) -> tuple[av.Instance | None, Arguments]:
    """Return the node of a call, and the arguments behind it or its interfaces."""
    if isinstance(owner, av.Instance) and is_node(owner):
        return owner, arguments
    count = 0
    while count < len(arguments.values) and first_node(arguments.values[count : count + 1]):
        count += 1
    return first_node(arguments.values), arguments.without_first(max(count, 1))


def create_endpoint(
    kind: DeclarationKind, machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`create_publisher<T>(topic, qos)`, `create_service<T>(name, callback)` and the like.

    As methods of a node, or as functions that take it, or its interfaces, first.
    """
    node, rest = split_node(owner, arguments)
    type = template_message_type(machine, rest) or callback_message_type(machine, rest, 1)
    return _declare_endpoint(kind, machine, node, type, rest)


def create_generic_endpoint(
    kind: DeclarationKind, machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`create_generic_publisher(topic, type, qos)`."""
    node, rest = split_node(owner, arguments)
    type = rest.get(1)
    written = str(type.value) if isinstance(type, av.Scalar) and av.is_text(type) else ""
    return _declare_endpoint(kind, machine, node, written, rest)


def _declare_endpoint(
    kind: DeclarationKind,
    machine: AbstractMachine,
    node: av.Value | None,
    type: str,
    rest: Arguments,
) -> av.Value:
    escape_functions(machine, rest)
    name = rest.get(0)
    if node is None:
        endpoints.note_unknown_node(machine, kind.value, name, rest)
        return av.Unknown(kind.value)
    plain = type
    for ending in _REQUEST_SUFFIXES if kind not in {_PUBLISH, _SUBSCRIBE} else ():
        plain = plain.removesuffix(ending)
    overridable = QosOverrides(machine, kind, node, rest)
    qos = overridable.effective_qos(
        resolve_at_node(node, name), _endpoint_qos(kind, rest), overriding_options_argument(rest)
    )
    full = endpoints.declare_endpoint(machine, kind, node, name, plain, rest, qos=qos)
    return av.Instance(ENDPOINT, {"name": full, "truth": av.TRUE})


def _endpoint_qos(kind: DeclarationKind, rest: Arguments) -> QoS | None:
    if kind not in {_PUBLISH, _SUBSCRIBE}:
        return None
    return read_qos(qos_argument(rest))


def qos_argument(rest: Arguments) -> av.Value | None:
    """Return the quality of service, or the depth, that stands behind a topic."""
    return next((v for v in rest.values[1:] if is_qos(v) or _is_depth(v)), None)


def _is_depth(value: av.Value) -> bool:
    number = value.value if isinstance(value, av.Scalar) else None
    return isinstance(number, int) and not isinstance(number, bool)


def create_timer(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`create_wall_timer(period, callback)`."""
    del owner
    escape_functions(machine, arguments)
    return av.Instance(_TIMER, {"truth": av.TRUE})


def _wait_for_message(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`rclcpp::wait_for_message(message, node, topic)`: the message's type is not looked at."""
    del owner
    node, rest = split_node(NO_OWNER, arguments.without_first(1))
    _declare_endpoint(_SUBSCRIBE, machine, node, template_message_type(machine, arguments), rest)
    return av.Unknown("wait_for_message")


NO_OWNER = av.Scalar(None)
ENDPOINT = av.LibraryClass(
    "rclcpp::Publisher",
    methods={
        **dict.fromkeys(("get_topic_name", "get_service_name"), returning_field("name")),
        **dict.fromkeys(
            ("async_send_request", "async_send_goal", "async_cancel_goal"), register_callbacks
        ),
        "shared_from_this": return_owner,
    },
)
_TIMER = av.LibraryClass("rclcpp::Timer")
_CALLS: Mapping[str, Callable[..., av.Value]] = {
    "create_publisher": partial(create_endpoint, _PUBLISH),
    "create_subscription": partial(create_endpoint, _SUBSCRIBE),
    "create_service": partial(create_endpoint, DeclarationKind.SERVICE),
    "create_client": partial(create_endpoint, DeclarationKind.SERVICE_CLIENT),
    "create_generic_publisher": partial(create_generic_endpoint, _PUBLISH),
    "create_generic_subscription": partial(create_generic_endpoint, _SUBSCRIBE),
    "create_generic_client": partial(create_generic_endpoint, DeclarationKind.SERVICE_CLIENT),
    "create_generic_service": partial(create_generic_endpoint, DeclarationKind.SERVICE),
    **dict.fromkeys(("create_wall_timer", "create_timer"), create_timer),
}
ENDPOINT_METHODS = _CALLS
ENDPOINT_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    **{f"rclcpp::{name}": call for name, call in _CALLS.items()},
    "rclcpp::wait_for_message": _wait_for_message,
    "rclcpp_action::create_server": partial(create_endpoint, DeclarationKind.ACTION_SERVER),
    "rclcpp_action::create_client": partial(create_endpoint, DeclarationKind.ACTION_CLIENT),
}


def _resolve_name(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`get_node_topics_interface()->resolve_topic_name(name)`."""
    return expand_name(arguments.value(0), node_name(owner))


_GRAPH_QUERIES = (
    *("count_publishers", "count_subscribers", "count_clients", "count_services"),
    *("get_publishers_info_by_topic", "get_subscriptions_info_by_topic"),
    *("get_clients_info_by_service", "get_servers_info_by_service"),
    *("get_service_names_and_types_by_node", "get_client_names_and_types_by_node"),
    *("get_publisher_names_and_types_by_node", "get_subscriber_names_and_types_by_node"),
    *("describe_parameter", "describe_parameters", "get_parameter_types"),
)
GRAPH_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(("resolve_topic_name", "resolve_service_name"), _resolve_name),
    **{name: returning_unknown(f"{name}()") for name in _GRAPH_QUERIES},
}

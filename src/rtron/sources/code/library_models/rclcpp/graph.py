"""What a node of rclcpp tells of names and of the graph (docs.ros.org: rclcpp::Node)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Instance,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.names import expand_name
from rtron.sources.code.library_models.ros2_common.nodes import node_name


def _resolve_name(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`get_node_topics_interface()->resolve_topic_name(name)`: it adds no sub-namespace."""
    return expand_name(arguments.get(0) or Unknown("?"), node_name(owner), Scalar(""))


def _unknown_graph_query(name: str, _: AbstractMachine, __: Instance, ___: Arguments) -> Value:
    """Return what only the running graph tells; what is asked for stays as it is."""
    return Unknown(f"{name}()")


_GRAPH_QUERIES = (
    *("count_publishers", "count_subscribers", "count_clients", "count_services"),
    *("get_publishers_info_by_topic", "get_subscriptions_info_by_topic"),
    *("get_clients_info_by_service", "get_servers_info_by_service"),
    *("get_service_names_and_types_by_node", "get_client_names_and_types_by_node"),
    *("get_publisher_names_and_types_by_node", "get_subscriber_names_and_types_by_node"),
    *("describe_parameter", "describe_parameters", "get_parameter_types", "list_parameters"),
)
GRAPH_METHODS: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(("resolve_topic_name", "resolve_service_name"), _resolve_name),
    **{name: partial(_unknown_graph_query, name) for name in _GRAPH_QUERIES},
}

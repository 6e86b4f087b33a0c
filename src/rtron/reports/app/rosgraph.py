"""An interaction graph in the shape of `rosgraph_msgs/msg/Graph`, as the fields of the message.

github.com/ros2/rcl_interfaces, package rosgraph_msgs: Graph, Node, Topic, Service, Action and
QoSProfile, with ParameterDescriptor and ParameterValue of rcl_interfaces. What a graph read from
source cannot know is left out and has the message's default: the hashes of types, and the QoS of
services. Policies that are not known are UNKNOWN. What client libraries add is left out.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from rtron.errors import InputError
from rtron.reports.app.node_endpoints import NodeEndpoints, endpoints_by_node
from rtron.vocabulary import (
    Action,
    Durability,
    Endpoint,
    InteractionGraph,
    Liveliness,
    NodeParameter,
    QoS,
    Reliability,
    Service,
    ServiceClient,
)

_NANOSECONDS = 10**9
_KEEP_LAST, _UNKNOWN = 1, 3
_RELIABILITIES = {Reliability.RELIABLE: 1, Reliability.BEST_EFFORT: 2}
_DURABILITIES = {Durability.TRANSIENT_LOCAL: 1, Durability.VOLATILE: 2}
_LIVELINESSES = {Liveliness.AUTOMATIC: 1, Liveliness.MANUAL_BY_TOPIC: 3}
_UNKNOWN_LIVELINESS = 4
_NOT_SET = 0
_VALUES: Mapping[type, tuple[int, str]] = {
    bool: (1, "bool_value"),
    int: (2, "integer_value"),
    float: (3, "double_value"),
    str: (4, "string_value"),
}
_ARRAYS: Mapping[type, tuple[int, str]] = {
    bool: (6, "bool_array_value"),
    int: (7, "integer_array_value"),
    float: (8, "double_array_value"),
    str: (9, "string_array_value"),
}
"""rcl_interfaces/msg/ParameterType."""
_CANCEL, _STATUS = "action_msgs/srv/CancelGoal", "action_msgs/msg/GoalStatusArray"


def graph_to_rosgraph(graph: InteractionGraph) -> dict[str, Any]:
    """Return a graph of ROS 2 as the message's fields."""
    if graph.ros == 1:
        raise InputError("the graph is of ROS 1", help="rosgraph_msgs describes nodes of ROS 2")
    return {"nodes": [_node(node) for node in endpoints_by_node(graph)]}


def _node(node: NodeEndpoints) -> dict[str, Any]:
    values = [_value(parameter) for parameter in node.parameters]
    return {
        "name": node.name,
        "parameters": [
            {"name": parameter.name, "type": value["type"]}
            for parameter, value in zip(node.parameters, values, strict=True)
        ],
        "parameter_values": values,
        "publishers": _topics(node.publishers),
        "subscriptions": _topics(node.subscriptions),
        "service_clients": [_service(client) for client in node.clients],
        "service_servers": [_service(service) for service in node.services],
        "action_clients": [_action(action) for action in node.action_clients],
        "action_servers": [_action(action) for action in node.action_servers],
    }


def _topics(endpoints: Iterable[Endpoint]) -> list[dict[str, Any]]:
    return [{"name": e.topic, "type": {"name": e.type}, "qos": _qos(e.qos)} for e in endpoints]


def _service(service: Service | ServiceClient) -> dict[str, Any]:
    return _service_fields(service.name, service.type)


def _service_fields(name: str, type: str) -> dict[str, Any]:
    """Return a service; its type stands at the request, as ros2's tools read it there."""
    return {"name": name, "request_type": {"name": type}, "response_type": {"name": type}}


def _action(action: Action) -> dict[str, Any]:
    """Return an action as the services and topics that it is made of (design.ros2.org: actions)."""
    below = f"{action.name}/_action"
    return {
        "name": action.name,
        "send_goal": _service_fields(f"{below}/send_goal", f"{action.type}_SendGoal"),
        "get_result": _service_fields(f"{below}/get_result", f"{action.type}_GetResult"),
        "cancel_goal": _service_fields(f"{below}/cancel_goal", _CANCEL),
        "feedback": {
            "name": f"{below}/feedback",
            "type": {"name": f"{action.type}_FeedbackMessage"},
        },
        "status": {"name": f"{below}/status", "type": {"name": _STATUS}},
    }


def _qos(qos: QoS | None) -> dict[str, Any]:
    if qos is None:
        policies = {"history": _UNKNOWN, "reliability": _UNKNOWN, "durability": _UNKNOWN}
        return {**policies, "liveliness": _UNKNOWN_LIVELINESS}
    return {
        "depth": qos.depth,
        "deadline": _duration(qos.deadline),
        "lifespan": _duration(qos.lifespan),
        "history": _KEEP_LAST if qos.depth else _UNKNOWN,
        "reliability": _RELIABILITIES[qos.reliability],
        "durability": _DURABILITIES[qos.durability],
        "liveliness": _LIVELINESSES.get(qos.liveliness, _UNKNOWN_LIVELINESS),
        "liveliness_lease_duration": _duration(qos.lease),
    }


def _duration(nanoseconds: int) -> dict[str, int]:
    seconds, rest = divmod(nanoseconds, _NANOSECONDS)
    return {"sec": seconds, "nanosec": rest}


def _value(parameter: NodeParameter) -> dict[str, Any]:
    value = parameter.value
    if not isinstance(value, tuple):
        kind, key = _VALUES.get(type(value), (_NOT_SET, ""))
        return {"type": kind, key: value} if key else {"type": _NOT_SET}
    kinds = {type(item) for item in value}
    kind, key = _ARRAYS[kinds.pop()] if len(kinds) == 1 else (_NOT_SET, "")
    return {"type": kind, key: list(value)} if key else {"type": _NOT_SET}

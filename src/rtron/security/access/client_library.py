"""What rcl, rclcpp and rclpy need for every node, whatever it does.

See rclcpp: ParameterService, TimeSource, NodeTypeDescriptions; rclpy: Node.
"""

from collections.abc import Iterator

from rtron.security.access.rights import AccessRight, RightKind

PARAMETER_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
)
_SERVICES = (*PARAMETER_SERVICES, "get_type_description")


def node_rights(node: str) -> Iterator[AccessRight]:
    """Yield what the client library does for a node, a full name or a pattern.

    The services are the node's own: to offer them lets nobody call them.
    """
    yield AccessRight(RightKind.PUBLISH, "/rosout")
    yield AccessRight(RightKind.PUBLISH, "/parameter_events")
    yield AccessRight(RightKind.SUBSCRIBE, "/parameter_events")
    yield AccessRight(RightKind.SUBSCRIBE, "/clock")
    for service in _SERVICES:
        yield AccessRight(RightKind.REPLY, f"{node}/{service}")

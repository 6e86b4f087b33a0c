"""What no node's author asked for: what client libraries add, and what is hidden by its name."""

from rtron.vocabulary import Direction

_IMPLICIT_TOPICS = frozenset({"/rosout", "/parameter_events"})
_CLOCK = "/clock"
_PARAMETER_SERVICE_PACKAGES = ("rcl_interfaces/srv/", "type_description_interfaces/srv/")


def is_hidden(name: str) -> bool:
    """Tell whether a part of the name begins with `_` (ROS 2 design: Topic and Service Names)."""
    return "/_" in name


def is_implicit_topic(topic: str, direction: Direction) -> bool:
    """Tell whether an end of a topic is the client library's, or hidden."""
    is_clock = topic == _CLOCK and direction is Direction.SUBSCRIBE
    return is_clock or topic in _IMPLICIT_TOPICS or is_hidden(topic)


def is_implicit_service(node: str, service: str, type: str) -> bool:
    """Tell whether a service is the client library's, like those of parameters, or hidden."""
    is_parameter_service = service.startswith(f"{node}/") and type.startswith(
        _PARAMETER_SERVICE_PACKAGES
    )
    return is_parameter_service or is_hidden(service)

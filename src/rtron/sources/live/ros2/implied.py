"""What no node's author asked for: what client libraries add, and what is hidden by its name."""

from rtron.vocabulary import Direction

_TOPICS = frozenset({"/rosout", "/parameter_events"})
_CLOCK = "/clock"
_SERVICES = ("rcl_interfaces/srv/", "type_description_interfaces/srv/")


def is_hidden(name: str) -> bool:
    """Tell whether a part of the name begins with `_` (ROS 2 design: Topic and Service Names)."""
    return "/_" in name


def implied_topic(topic: str, direction: Direction) -> bool:
    """Tell whether an end of a topic is the client library's, or hidden."""
    clock = topic == _CLOCK and direction is Direction.SUBSCRIBE
    return clock or topic in _TOPICS or is_hidden(topic)


def implied_service(node: str, service: str, type: str) -> bool:
    """Tell whether a service is the client library's, like those of parameters, or hidden."""
    own = service.startswith(f"{node}/") and type.startswith(_SERVICES)
    return own or is_hidden(service)

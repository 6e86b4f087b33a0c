"""DDS's names of a service: two topics, one of requests and one of replies.

See design.ros2.org: Topic and Service name mapping to DDS. No ROS name begins as these do.
"""

_REQUEST = "rq", "Request"
_REPLY = "rr", "Reply"


def request_topic(service: str) -> str:
    """Return DDS's name of the topic on which a service is called."""
    return service.join(_REQUEST)


def reply_topic(service: str) -> str:
    """Return DDS's name of the topic on which a service is answered."""
    return service.join(_REPLY)


def is_service_topic(topic: str) -> bool:
    """Tell whether a topic is one of a service's two."""
    return not topic.startswith("/")


def ros_name(topic: str) -> str:
    """Return the ROS name of a topic or of the service that it belongs to."""
    for prefix, suffix in (_REQUEST, _REPLY):
        if topic.startswith(prefix):
            return topic.removeprefix(prefix).removesuffix(suffix)
    return topic

"""Which topics and nodes belong to an action (actionlib's five topics move as one unit)."""

from collections import defaultdict

from rtron.vocabulary import ActionRole, Endpoint, InteractionGraph, normalise_type

ACTION_TOPIC_NAMES = ("goal", "cancel", "status", "feedback", "result")


def all_topics(graph: InteractionGraph) -> frozenset[str]:
    """Return the topics of a graph, those that only its endpoints name too."""
    listed = (topic.name for topic in graph.topics)
    return frozenset(listed).union(endpoint.topic for endpoint in graph.endpoints)


def action_topics(graph: InteractionGraph) -> frozenset[str]:
    """Return the topics of every action: those the graph names, and those known by their five."""
    topics = all_topics(graph)
    namespaces: dict[str, int] = defaultdict(int)
    for topic in topics:
        namespace, _, part = topic.rpartition("/")
        namespaces[namespace] += part in ACTION_TOPIC_NAMES
    action_names = {action.name for action in graph.actions}
    complete = {
        namespace for namespace, parts in namespaces.items() if parts == len(ACTION_TOPIC_NAMES)
    }
    return (
        frozenset(
            f"{namespace}/{part}"
            for namespace in action_names | complete
            for part in ACTION_TOPIC_NAMES
        )
        & topics
    )


def action_servers(graph: InteractionGraph) -> dict[str, tuple[str, ...]]:
    """Return the nodes that serve actions, each with the names of its actions in order."""
    servers: dict[str, set[str]] = defaultdict(set)
    for action in graph.actions:
        if action.role is ActionRole.SERVER:
            servers[action.node].add(action.name)
    for topic in action_topics(graph):
        if topic.endswith("/result"):
            for endpoint in graph.publishers(topic):
                servers[endpoint.node].add(_action_namespace(endpoint))
    return {node: tuple(sorted(names)) for node, names in servers.items()}


def _action_namespace(endpoint: Endpoint) -> str:
    return endpoint.topic.rpartition("/")[0]


_IMAGES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")
_PER_FRAME = (
    *_IMAGES,
    "sensor_msgs/CameraInfo",
    "sensor_msgs/PointCloud2",
    "stereo_msgs/DisparityImage",
    "theora_image_transport/Packet",
)
_LARGE = (*_IMAGES, "sensor_msgs/PointCloud", "sensor_msgs/PointCloud2")


def is_image(message_type: str) -> bool:
    """Tell whether a message is an image, compressed or not."""
    return normalise_type(message_type) in _IMAGES


def is_sent_per_frame(message_type: str) -> bool:
    """Tell whether such a message comes for every frame, whatever is to be seen in it."""
    return normalise_type(message_type) in _PER_FRAME


def is_large(message_type: str) -> bool:
    """Tell whether such a message usually has megabytes: a picture or a point cloud."""
    return normalise_type(message_type) in _LARGE

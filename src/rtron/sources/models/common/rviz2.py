"""What an rviz of ROS 2 shows and sends, from its configuration file (docs.ros.org: rviz2)."""

from collections.abc import Iterator, Mapping
from typing import Any

from rtron.sources.models.common.node_files import read_yaml_file
from rtron.sources.models.common.rviz import (
    TOPIC_KEYS,
    TYPES,
    enabled_displays,
    mappings_of,
    visualization_manager,
)
from rtron.sources.models.common.values import Value, has_placeholder

_TOOLS = {
    "SetInitialPose": ("initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped"),
    "SetGoal": ("goal_pose", "geometry_msgs/msg/PoseStamped"),
    "PublishPoint": ("clicked_point", "geometry_msgs/msg/PointStamped"),
}
_DESCRIPTION, _MARKERS = "Description Topic", "Interactive Markers Namespace"
_TOPIC_KEYS = (*TOPIC_KEYS, _DESCRIPTION, "Color Image Topic")
_TYPES = {"Update Topic": "map_msgs/msg/OccupancyGridUpdate", _DESCRIPTION: "std_msgs/msg/String"}
_CAMERA_INFO_DISPLAYS = {("Camera", "Topic"), ("DepthCloud", "Depth Map Topic")}
"""Displays that also subscribe to `camera_info` next to the topic of this key."""

_ROS1_PREFIX, _ROS2_PREFIX = "rviz/", "rviz_default_plugins/"
_MARKER_DISPLAY = "rviz_default_plugins/Marker"
_OTHER_TYPES = {"nav2_rviz_plugins/ParticleCloud": "nav2_msgs/msg/ParticleCloud"}


def rviz2_subscriptions(config: Value) -> list[dict[str, str]]:
    """Return topic, type and qos of every enabled display of a configuration file."""
    tree = visualization_manager(config)
    if has_placeholder(tree):
        return [{"topic": str(tree)}]
    return [
        topic
        for display in enabled_displays(tree.get("Displays"))
        for topic in _display_topics(display)
    ]


def rviz2_publications(config: Value) -> list[dict[str, str]]:
    """Return topic, type and qos of every tool of a configuration file that publishes."""
    tree = visualization_manager(config)
    tools = [] if has_placeholder(tree) else mappings_of(tree.get("Tools"))
    if has_placeholder(tree) or not config:
        tools = [{"Class": _ROS2_PREFIX + name} for name in _TOOLS]
    return [sent for tool in tools for sent in _tool_topics(tool)]


def rviz2_markers(config: Value) -> list[str]:
    """Return the namespaces of the enabled displays of interactive markers."""
    tree = visualization_manager(config)
    enabled = () if has_placeholder(tree) else enabled_displays(tree.get("Displays"))
    named = (display.get(_MARKERS) for display in enabled)
    return [name.rstrip("/") for name in named if isinstance(name, str) and name.strip("/")]


def rviz2_panels(config: Value) -> list[str]:
    """Return the classes of a configuration file's panels; none where the file is not known."""
    tree = read_yaml_file(config) if config else {}
    panels = mappings_of(tree.get("Panels")) if isinstance(tree, Mapping) else []
    return [str(panel.get("Class", "")) for panel in panels]


def _display_topics(display: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    kind = str(display.get("Class", ""))
    is_file = display.get("Description Source") == "File"
    for key in _TOPIC_KEYS:
        topic = display.get(key)
        topic = topic if isinstance(topic, Mapping) else {"Value": topic}
        name = topic.get("Value")
        if not isinstance(name, str) or not name or (key == _DESCRIPTION and is_file):
            continue
        yield {"topic": name, "type": _TYPES.get(key, _type(kind)), "qos": _qos(topic)}
        if kind == _MARKER_DISPLAY:
            array = "visualization_msgs/msg/MarkerArray"
            yield {"topic": f"{name}_array", "type": array, "qos": _qos(topic)}
        if (kind.removeprefix(_ROS2_PREFIX), key) in _CAMERA_INFO_DISPLAYS:
            info = f"{name.rpartition('/')[0]}/camera_info"
            yield {"topic": info, "type": "sensor_msgs/msg/CameraInfo", "qos": "5 best_effort"}


def _type(kind: str) -> str:
    if kind in _OTHER_TYPES:
        return _OTHER_TYPES[kind]
    package, _, name = TYPES.get(kind.replace(_ROS2_PREFIX, _ROS1_PREFIX, 1), "").partition("/")
    return f"{package}/msg/{name}" if name else ""


def _tool_topics(tool: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    kind = str(tool.get("Class", ""))
    if kind.removeprefix(_ROS2_PREFIX) not in _TOOLS or not kind.startswith(_ROS2_PREFIX):
        return
    default, type = _TOOLS[kind.removeprefix(_ROS2_PREFIX)]
    topic = tool.get("Topic")
    topic = topic if isinstance(topic, Mapping) else {}
    name = topic.get("Value")
    yield {
        "topic": name if isinstance(name, str) and name else default,
        "type": type,
        "qos": _qos(topic),
    }


def _qos(topic: Mapping[str, Any]) -> str:
    """Return the quality of service in the words of models."""
    reliable = topic.get("Reliability Policy", "Reliable") != "Best Effort"
    is_transient_local = topic.get("Durability Policy", "Volatile") == "Transient Local"
    depth = topic.get("Depth", 5)
    tokens = [str(depth) if isinstance(depth, int) and depth >= 0 else "5"]
    tokens += [] if reliable else ["best_effort"]
    return " ".join([*tokens, "transient_local"] if is_transient_local else tokens)

"""What an rviz shows and sends, from its configuration file (ROS wiki: rviz/UserGuide)."""

from collections.abc import Iterator, Mapping
from typing import Any

from rtron.sources.models.common.node_files import read_yaml_file
from rtron.sources.models.common.values import Value, has_placeholder

_MAX_DEPTH = 20
_MOTION_PLANNING, _MOVE_GROUP = "moveit_rviz_plugin/MotionPlanning", "Move Group Namespace"
_GROUPS = ("rviz/Group", "rviz_common/Group")
TOPIC_KEYS = ("Topic", "Marker Topic", "Update Topic", "Image Topic", "Depth Map Topic")
TYPES = {
    "rviz/Camera": "sensor_msgs/Image",
    "rviz/DepthCloud": "sensor_msgs/Image",
    "rviz/Effort": "sensor_msgs/JointState",
    "rviz/FluidPressure": "sensor_msgs/FluidPressure",
    "rviz/GridCells": "nav_msgs/GridCells",
    "rviz/Illuminance": "sensor_msgs/Illuminance",
    "rviz/Image": "sensor_msgs/Image",
    "rviz/InteractiveMarkers": "visualization_msgs/InteractiveMarkerUpdate",
    "rviz/LaserScan": "sensor_msgs/LaserScan",
    "rviz/Map": "nav_msgs/OccupancyGrid",
    "rviz/Marker": "visualization_msgs/Marker",
    "rviz/MarkerArray": "visualization_msgs/MarkerArray",
    "rviz/Odometry": "nav_msgs/Odometry",
    "rviz/Path": "nav_msgs/Path",
    "rviz/PointCloud": "sensor_msgs/PointCloud",
    "rviz/PointCloud2": "sensor_msgs/PointCloud2",
    "rviz/PointStamped": "geometry_msgs/PointStamped",
    "rviz/Polygon": "geometry_msgs/PolygonStamped",
    "rviz/Pose": "geometry_msgs/PoseStamped",
    "rviz/PoseArray": "geometry_msgs/PoseArray",
    "rviz/PoseWithCovariance": "geometry_msgs/PoseWithCovarianceStamped",
    "rviz/Range": "sensor_msgs/Range",
    "rviz/RelativeHumidity": "sensor_msgs/RelativeHumidity",
    "rviz/Temperature": "sensor_msgs/Temperature",
    "rviz/WrenchStamped": "geometry_msgs/WrenchStamped",
    "rviz/TwistStamped": "geometry_msgs/TwistStamped",
    "rviz/AccelStamped": "geometry_msgs/AccelStamped",
}
_TOOLS = {
    "rviz/SetInitialPose": ("initialpose", "geometry_msgs/PoseWithCovarianceStamped"),
    "rviz/SetGoal": ("/move_base_simple/goal", "geometry_msgs/PoseStamped"),
    "rviz/PublishPoint": ("/clicked_point", "geometry_msgs/PointStamped"),
}


def rviz_subscriptions(config: Value) -> list[dict[str, str]]:
    """Return topic and type of every enabled display of a configuration file."""
    tree = visualization_manager(config)
    if has_placeholder(tree):
        return [{"topic": str(tree), "type": ""}]
    return [
        values
        for display in enabled_displays(tree.get("Displays"))
        for values in _display_topics(display)
    ]


def rviz_publications(config: Value) -> list[dict[str, str]]:
    """Return topic and type of every tool of a configuration file that publishes."""
    tree = visualization_manager(config)
    tools = [] if has_placeholder(tree) else mappings_of(tree.get("Tools"))
    if has_placeholder(tree) or not config:
        tools = [{"Class": name} for name in _TOOLS]
    return [_tool_topic(tool) for tool in tools if tool.get("Class") in _TOOLS]


def rviz_move_groups(config: Value) -> list[str]:
    """Return the namespace, with a slash, of each move_group that a display sends goals to."""
    tree = visualization_manager(config)
    enabled = () if has_placeholder(tree) else enabled_displays(tree.get("Displays"))
    planning = (display for display in enabled if display.get("Class") == _MOTION_PLANNING)
    names = (str(display.get(_MOVE_GROUP) or "") for display in planning)
    return [f"{name.rstrip('/')}/" if name.strip("/") else "" for name in names]


def visualization_manager(config: Value) -> Any:  # noqa: ANN401 - a mapping or a hole
    """Return what stands below `Visualization Manager` in a configuration file; a hole for none."""
    tree = read_yaml_file(config) if config else {}
    if has_placeholder(tree):
        return tree
    manager = tree.get("Visualization Manager") if isinstance(tree, Mapping) else None
    return manager if isinstance(manager, Mapping) else {}


def enabled_displays(listed: object, depth: int = 0) -> Iterator[Mapping[str, Any]]:
    """Yield the displays that are switched on, those of groups too."""
    for display in mappings_of(listed):
        if display.get("Enabled", True) is not True or depth > _MAX_DEPTH:
            continue
        if display.get("Class") in _GROUPS:
            yield from enabled_displays(display.get("Displays"), depth + 1)
        else:
            yield display


def _display_topics(display: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    kind = str(display.get("Class", ""))
    for key in TOPIC_KEYS:
        topic = display.get(key)
        if not isinstance(topic, str) or not topic:
            continue
        yield {"topic": topic, "type": TYPES.get(kind, "")}
        yield from _related_topics(kind, key, topic)


def _related_topics(kind: str, key: str, topic: str) -> Iterator[dict[str, str]]:
    if kind == "rviz/Map":
        yield {"topic": f"{topic}_updates", "type": "map_msgs/OccupancyGridUpdate"}
    if kind == "rviz/Camera" and key == "Image Topic":
        parent = topic.rpartition("/")[0]
        yield {"topic": f"{parent}/camera_info", "type": "sensor_msgs/CameraInfo"}


def _tool_topic(tool: Mapping[str, Any]) -> dict[str, str]:
    default, type = _TOOLS[str(tool["Class"])]
    topic = tool.get("Topic")
    return {"topic": topic if isinstance(topic, str) and topic else default, "type": type}


def mappings_of(items: object) -> list[Mapping[str, Any]]:
    """Return the mappings of a list."""
    values = items if isinstance(items, list) else []
    return [item for item in values if isinstance(item, Mapping)]

"""What an rviz shows and sends, from its configuration file (ROS wiki: rviz/UserGuide)."""

from collections.abc import Iterator, Mapping
from typing import Any

from rtron.sources.models.common.node_files import yaml_file
from rtron.sources.models.common.values import Value, has_hole

_MAX_DEPTH = 20
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
    tree = manager(config)
    if has_hole(tree):
        return [{"topic": str(tree), "type": ""}]
    return [found for display in displays(tree.get("Displays")) for found in _shown(display)]


def rviz_publications(config: Value) -> list[dict[str, str]]:
    """Return topic and type of every tool of a configuration file that publishes."""
    tree = manager(config)
    tools = [] if has_hole(tree) else mappings(tree.get("Tools"))
    if has_hole(tree) or not config:
        tools = [{"Class": name} for name in _TOOLS]
    return [_sent(tool) for tool in tools if tool.get("Class") in _TOOLS]


def manager(config: Value) -> Any:  # noqa: ANN401 - a mapping or a hole
    """Return what stands below `Visualization Manager` in a configuration file; a hole for none."""
    tree = yaml_file(config) if config else {}
    if has_hole(tree):
        return tree
    manager = tree.get("Visualization Manager") if isinstance(tree, Mapping) else None
    return manager if isinstance(manager, Mapping) else {}


def displays(listed: object, depth: int = 0) -> Iterator[Mapping[str, Any]]:
    """Yield the displays that are switched on, those of groups too."""
    for display in mappings(listed):
        if display.get("Enabled", True) is not True or depth > _MAX_DEPTH:
            continue
        if display.get("Class") in _GROUPS:
            yield from displays(display.get("Displays"), depth + 1)
        else:
            yield display


def _shown(display: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    kind = str(display.get("Class", ""))
    for key in TOPIC_KEYS:
        topic = display.get(key)
        if not isinstance(topic, str) or not topic:
            continue
        yield {"topic": topic, "type": TYPES.get(kind, "")}
        yield from _beside(kind, key, topic)


def _beside(kind: str, key: str, topic: str) -> Iterator[dict[str, str]]:
    if kind == "rviz/Map":
        yield {"topic": f"{topic}_updates", "type": "map_msgs/OccupancyGridUpdate"}
    if kind == "rviz/Camera" and key == "Image Topic":
        parent = topic.rpartition("/")[0]
        yield {"topic": f"{parent}/camera_info", "type": "sensor_msgs/CameraInfo"}


def _sent(tool: Mapping[str, Any]) -> dict[str, str]:
    default, type = _TOOLS[str(tool["Class"])]
    topic = tool.get("Topic")
    return {"topic": topic if isinstance(topic, str) and topic else default, "type": type}


def mappings(items: object) -> list[Mapping[str, Any]]:
    """Return the mappings of a list."""
    found = items if isinstance(items, list) else []
    return [item for item in found if isinstance(item, Mapping)]

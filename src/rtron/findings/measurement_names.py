"""What names tell of a measurement, and not of a command: those of topics, and those of nodes.

Ask them only where neither the type nor the direction of an endpoint tells it already.
"""

import re

from rtron.vocabulary import Node
from rtron.vocabulary.names import snake_case

MEASURED_TYPES = re.compile(r"sensor_msgs/(?!Joy)|nav_msgs/(?:Odometry|OccupancyGrid|GridCells)")
"""Types of what is measured, as ROS 1 spells them."""
_COMMANDED = re.compile(r"cmd|command|setpoint")
"""Words in the names of what is no measurement, whatever else they say."""
_MEASURED = re.compile(
    r"^(?:measured|estimated|actual|prev|previous|debug)_|_(?:actual|debug)$"
    r"|^act_(?:vel|speed|twist|pos)"
    rf"|^current_(?!\w*(?:{_COMMANDED.pattern}))"
    rf"|^(?:gps|odom|imu)_(?!\w*(?:{_COMMANDED.pattern}|goal|waypoint|target|search))"
)
_MEASURED_BELOW = re.compile(
    r"/(?:local_position|global_position|odometry|odom|feedback|measured|sensors?"
    r"|navsat|gnss|gps|imu|vicon|mocap)/"
    r"|(?:^|[/_])(?:image|compressed|(?<!path_)(?<!way_)points)(?:[/_]|$)|(?:^|/)depth(?:[/_]|$)"
)
"""Namespaces of what is measured, and words of what is seen."""
_MAYBE_MEASURED = re.compile(
    r"odom|estimat|measured|actual|feedback|ground_truth|local_position"
    r"|(?:^|[/_])(?:state|status|imu|gps|error)(?:[/_]|$)"
    r"|(?:^|/)(?:wheels?|encoders?|real|true|sensed)_?(?:vel\w*|speeds?|twist)$"
    r"|(?:^|/)(?:vel|velocity|speed|twist|fix)_(?:raw|meas\w*|real|est|fb|velocity)$"
)
_SENSORS = re.compile(
    r"(?:^|[\W_])(?:(?:camera|lidar|laser|image|video|imu|gps|gnss|navsat|nmea|map|mapping|slam)s?"
    r"|realsense2?|rplidar|velodyne|ouster|hokuyo|urg|depthai|zed|usbcam|amcl|cartographer|rtabmap"
    r"|localization|ekf|rviz2?|description|tf2?|yolo\w*|detector|detection|audio|speech|e?speak|tts|leds?"
    r"|diagnostics?|message_info)(?:[\W_]|$)"
)
"""Words in the names of what neither sends commands of motion nor obeys them."""
_MOVES = re.compile(
    r"(?:^|[\W_])(?:base|chassis|rover|robot|vehicle|drone|nav|navigation|waypoint|follower|teleop"
    r"|cmd|command|control|controller|actuator|motor|wheel|drive|servo|vel|velocity|speed|throttle"
    r"|brake|steering|thruster|rudder|propeller|arm|joint|leg|hand|finger|claw|gripper|manipulator"
    r"|head|neck|mast|pan|tilt|ptz|gimbal|winch|pump|valve|relay|dock)s?\d*"
    r"(?![a-z\d]|_description|_localization)"
)
"""Words beside those that say that it may do so all the same: `camera_rover_driver`."""


def is_measured(topic: str) -> bool:
    """Return whether a topic's name says that it is a measurement, whoever subscribes it."""
    name = snake_case(topic)
    last = name.rpartition("/")[2]
    is_below = _MEASURED_BELOW.search(name) and not _COMMANDED.search(last)
    return bool(is_below or _MEASURED.search(last))


def may_be_measured(topic: str) -> bool:
    """Return whether a topic's name says that it is a measurement, unless a driver obeys it."""
    name = snake_case(topic)
    return bool(_MAYBE_MEASURED.search(name)) and not _COMMANDED.search(name)


def moves_nothing(name: str) -> bool:
    """Return whether a part of the name of a node or a file says that it commands no motion."""
    parts = (part for part in name.lower().split("/") if not _MOVES.search(part))
    return any(map(_SENSORS.search, parts))


def is_called_sensor(node: Node) -> bool:
    """Return whether a node's name and its package's say that it neither commands nor obeys."""
    return moves_nothing(f"{node.name.rpartition('/')[2]}_{node.package}")

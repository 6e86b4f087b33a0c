"""Copy between device frames and messages, whose fields are the same in ROS 1 and ROS 2.

A node makes the message, stamps it, and has its fields filled in here.
"""

from array import array
from math import isfinite
from sys import byteorder
from typing import Any

from .device import Device, Head
from .geometry import Pose, Velocity, heading, quaternion
from .journal import Journal

Message = Any
"""A message of rospy or rclpy."""


def send_velocity(device: Device, journal: Journal, twist: Message) -> None:
    """Hand a Twist to the base and note it; one that is not finite is only noted."""
    velocity = velocity_in(twist)
    journal.received("/cmd_vel", velocity)
    if all(map(isfinite, velocity)):
        device.send(velocity=velocity)


def fill_odometry(odometry: Message, head: Head) -> None:
    """Fill in an Odometry from a frame of the base."""
    odometry.header.frame_id, odometry.child_frame_id = "odom", "base_footprint"
    pose, twist = odometry.pose.pose, odometry.twist.twist
    pose.position.x, pose.position.y, turn = map(float, head["pose"])
    pose.orientation.z, pose.orientation.w = quaternion(turn)
    twist.linear.x, twist.angular.z = map(float, head["velocity"])


def fill_transform(transform: Message, odometry: Message) -> None:
    """Fill in the TransformStamped that says the same as an Odometry, its stamp too."""
    transform.header = odometry.header
    transform.child_frame_id = odometry.child_frame_id
    pose = odometry.pose.pose
    transform.transform.translation.x = pose.position.x
    transform.transform.translation.y = pose.position.y
    transform.transform.rotation = pose.orientation


def fill_scan(scan: Message, head: Head, blob: bytes) -> None:
    """Fill in a LaserScan from a frame of the lidar (float32, little-endian, metres)."""
    scan.header.frame_id = "base_scan"
    for name in ("angle_min", "angle_increment", "range_min", "range_max"):
        setattr(scan, name, float(head[name]))
    ranges = array("f", blob)
    if byteorder == "big":
        ranges.byteswap()
    scan.angle_max = scan.angle_min + scan.angle_increment * (len(ranges) - 1)
    scan.ranges = ranges


def fill_image(image: Message, head: Head) -> None:
    """Fill in all of an Image but its data, from a frame of the camera."""
    image.header.frame_id = "camera_rgb_optical_frame"
    image.width, image.height = head["width"], head["height"]
    image.encoding, image.step = "rgb8", 3 * head["width"]


def fill_battery(battery: Message, head: Head) -> None:
    """Fill in a BatteryState (discharging, present) from a frame of the battery."""
    battery.percentage, battery.voltage = float(head["percentage"]), float(head["voltage"])
    battery.power_supply_status = battery.POWER_SUPPLY_STATUS_DISCHARGING
    battery.present = True


def fill_goal(goal: Message, point: tuple[float, float]) -> None:
    """Fill in a PoseStamped on the map, facing along the x axis."""
    goal.header.frame_id = "map"
    goal.pose.position.x, goal.pose.position.y = map(float, point)
    goal.pose.orientation.w = 1.0


def fill_twist(twist: Message, velocity: Velocity) -> None:
    """Fill in a Twist: m/s forwards, rad/s to the left."""
    twist.linear.x, twist.angular.z = velocity


def velocity_in(twist: Message) -> Velocity:
    """Return the velocity of a Twist: m/s forwards, rad/s to the left."""
    return twist.linear.x, twist.angular.z


def pose_in(odometry: Message) -> Pose:
    """Return the pose of an Odometry."""
    pose = odometry.pose.pose
    turn = heading(pose.orientation.z, pose.orientation.w)
    return pose.position.x, pose.position.y, turn

"""What is known of packages of the ROS distributions, whatever app uses them."""

from collections.abc import Collection

NETWORK_BRIDGES = {
    "rosbridge_server": "WebSocket clients",
    "foxglove_bridge": "Foxglove clients",
    "ros2_web_bridge": "WebSocket clients",
    "zenoh_bridge_ros2dds": "every Zenoh peer",
    "zenoh_bridge_dds": "every Zenoh peer",
    "ddsrouter_tool": "participants of the other domain",
    "tcp_ros_bridge": "TCP clients",
    "ros_tcp_endpoint": "TCP clients",
}
"""Packages whose nodes let others than nodes publish on every topic, and whom."""
CARRIER_PACKAGES = NETWORK_BRIDGES.keys() | {
    *("mqtt_bridge", "mqtt_client", "domain_bridge", "ros1_bridge", "micro_ros_agent")
}
"""Packages whose nodes speak on any topic for others; remaps move what these say, or nothing."""
_STACKS = (("nav2_", "opennav_"), ("move_base", "moveit"), ("autoware_",), ("gazebo_", "ros_gz"))
"""Prefixes of packages whose nodes take turns among themselves."""


def are_one_stack(packages: Collection[str]) -> bool:
    """Return whether packages belong to one stack, whose nodes take turns among themselves."""
    return any(all(package.startswith(stack) for package in packages) for stack in _STACKS)

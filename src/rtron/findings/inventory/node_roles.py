"""What the nodes of an app are in the inventory: next to hardware, sensors, or listeners only."""

import re
from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

from rtron.findings.app_facts import AppFacts
from rtron.findings.measurement_names import is_called_sensor, is_measured, may_be_measured
from rtron.findings.node_kinds import carriers, moves
from rtron.vocabulary import Direction, Node, WiringFact, WiringFactKind, normalise_type
from rtron.vocabulary.names import EMERGENCY_STOP, snake_case

FIRMWARE_PACKAGES = (
    *("rosserial_arduino", "rosserial_python", "rosserial_server", "rosserial_xbee"),
    "micro_ros_agent",
)
"""Packages whose nodes speak for firmware, which no scan reads."""
_DRIVER_PACKAGES = (
    *("diff_drive_controller", "ackermann_steering_controller", "mecanum_drive_controller"),
    *("tricycle_controller", "omni_wheel_drive_controller", "steering_controllers_library"),
    *("bicycle_steering_controller", "joint_trajectory_controller", "forward_command_controller"),
    *("velocity_controllers", "position_controllers", "effort_controllers", "gripper_controllers"),
    *("gazebo_ros", "gazebo_plugins", "ros_gz_bridge", "ros_ign_bridge", "stage_ros", "turtlesim"),
    *("kobuki_node", "create_driver", "turtlebot3_node", "mavros", "vesc_driver"),
    *FIRMWARE_PACKAGES,
)
"""Packages whose nodes stand next to hardware or a simulation, whatever they publish."""
_SCANS_AND_IMAGES = frozenset(
    {"sensor_msgs/LaserScan", "sensor_msgs/Image", "sensor_msgs/PointCloud2"}
)
_SHOWING = r"lights?|leds?|lcd|sound|display\w*|speech\w*|radio|modem"
"""Words in the names of nodes that show, sound or transmit, also by hardware that they open."""
_LISTENERS = re.compile(
    r"(?:filter|locali[sz]|odom|estimat|ekf|record|visuali|plot|marker)\w*"
    rf"|{_SHOWING}|gui|log(?:s|ger|ging)?|debug|collector|status|web(?:site|page|app)?|reports?"
)
"""Words in the names of nodes that hear commands and obey none."""
MOVING_HARDWARE = frozenset(
    {"motor controller", "vehicle link", "servo bus", "EtherCAT", "servo driver", "PWM output"}
)
"""What a node opens to move something, and seldom only to read."""
_SENSED = frozenset({"sensor_msgs/Imu", "sensor_msgs/NavSatFix"})
_MOVED = frozenset({"nav_msgs/Odometry", "sensor_msgs/JointState"})


@dataclass(frozen=True)
class NodeRoles:
    """Tells of each node of an app what it is, by its package, its source and its topics."""

    app: AppFacts

    def devices(self, nodes: tuple[str, ...]) -> tuple[WiringFact, ...]:
        """Return what the source of nodes opens."""
        return tuple(
            fact
            for fact in self.app.graph.wiring
            if fact.kind is WiringFactKind.DEVICE and fact.subject in nodes
        )

    @cached_property
    def with_device(self) -> frozenset[str]:
        """The nodes whose source opens hardware; what they connect to may be a cloud."""
        opened = self.devices(tuple(self.app.nodes))
        return frozenset(fact.subject for fact in opened if fact.value != "TCP link")

    @cached_property
    def _controller_hosts(self) -> frozenset[str]:
        """The nodes in which controllers run, next to the hardware."""
        services = self.app.graph.services
        return frozenset(e.node for e in services if e.type.endswith("/SwitchController"))

    @cached_property
    def beside_hardware(self) -> frozenset[str]:
        """The nodes that open hardware or connect to it, or that hardware of ros2_control makes."""
        hosts = (self.app.nodes[name] for name in self._controller_hosts & self.app.nodes.keys())
        processes = {host.process or host.name for host in hosts}
        inside = (n.name for n in self.app.graph.nodes if n.process in processes)
        outside = (fact.subject for fact in self.devices(tuple(self.app.nodes)))
        return frozenset(name for name in inside if not self.is_controller(name)).union(outside)

    def package(self, node: str) -> str:
        """Return a node's package, empty if it is not known."""
        return self.app.nodes[node].package if node in self.app.nodes else ""

    def is_autopilot(self, node: str) -> bool:
        """Return whether a node is an autopilot, or talks to one."""
        links = (fact.value for fact in self.devices((node,)))
        return self.package(node) == "mavros" or "vehicle link" in links

    def is_sensor(self, node: str) -> bool:
        """Return whether a node measures and obeys no motion: its motor turns a lidar."""
        return node in self._sensors

    @cached_property
    def _sensors(self) -> frozenset[str]:
        return frozenset(n for n in self._sent_types if self._only_measures(n))

    def _only_measures(self, node: str) -> bool:
        if self.is_autopilot(node) or self._sent_types[node].isdisjoint(_SCANS_AND_IMAGES):
            return False
        return not any(self.app.is_motion(end.topic) for end in self.app.graph.subscribed_by(node))

    @cached_property
    def _sent_types(self) -> dict[str, frozenset[str]]:
        """The types of what each node publishes, as ROS 1 spells them."""
        found = defaultdict[str, set[str]](set)
        for end in self.app.graph.endpoints:
            if end.direction is Direction.PUBLISH:
                found[end.node].add(normalise_type(end.type))
        return {node: frozenset(types) for node, types in found.items()}

    def is_called_sensor(self, node: str) -> bool:
        """Return whether the names of a node and its package say that it moves nothing."""
        return node in self.app.nodes and is_called_sensor(self.app.nodes[node])

    def measures_motion(self, node: str, *, is_driver: bool) -> bool:
        """Return whether a node senses where it is or how it moves; a driver by odometry, too."""
        types = self._sent_types.get(node, frozenset())
        return not types.isdisjoint(_SENSED | _MOVED if is_driver else _SENSED)

    def obeys(self, node: str) -> bool:
        """Return whether a node that hears a command may obey it: an estimator only listens."""
        return node not in self._listeners

    @cached_property
    def firmware(self) -> frozenset[str]:
        """The nodes that speak for firmware; what it obeys is not read."""
        nodes = (node for node in self.app.unread_nodes if self.package(node) in FIRMWARE_PACKAGES)
        return frozenset(node for node in nodes if not self.is_called_sensor(node))

    def is_sketch(self, node: str) -> bool:
        """Return whether a node speaks for firmware, of which a sketch in the source was read."""
        return self.package(node) in FIRMWARE_PACKAGES and node not in self.app.unread_nodes

    @cached_property
    def _listeners(self) -> frozenset[str]:
        """The nodes that obey and command nothing, as their names say, or what they send."""
        named = {n.name for n in self.app.graph.nodes if _has_word(n, _LISTENERS)}
        showing = {n.name for n in self.app.graph.nodes if _has_word(n, re.compile(_SHOWING))}
        sends = self.app.graph.published_by
        commands = (n for n in named if any(self.app.is_motion(e.topic) for e in sends(n)))
        drivers = (n for n in named - showing if self.drives(n) or self.is_called_driver(n))
        return frozenset(named.difference(commands, drivers))

    def only_measures(self, topic: str) -> bool:
        """Return whether a topic of motion commands nothing.

        Those alone hear it that obey nothing, or sensors send it, its name says that it was
        measured, and no driver hears it.
        """
        readers, senders = self.app.readers(topic), self.app.publishers(topic)
        if self.app.is_stop(topic) or any(map(self.may_obey, readers)):
            return False
        is_named = is_measured(topic) or may_be_measured(topic)
        is_sensed = is_named and bool(senders) and all(map(self._measures, senders))
        return is_sensed or (bool(readers) and not any(map(self.obeys, readers)))

    def _measures(self, node: str) -> bool:
        return self.is_called_sensor(node) or self.measures_motion(node, is_driver=False)

    def drives(self, node: str) -> bool:
        """Return whether a node stands next to hardware or a simulation."""
        is_driver = self.package(node) in _DRIVER_PACKAGES or node in self.with_device
        return is_driver or node in self._controller_hosts or self.is_controller(node)

    def moves_hardware(self, node: str) -> bool:
        """Return whether a node opens hardware and measures nothing with it."""
        is_other = self.is_sensor(node) or self.measures_motion(node, is_driver=False)
        return node in self.with_device and self.obeys(node) and not is_other

    def is_actuating(self, node: str) -> bool:
        """Return whether a node opens hardware, and is no sensor by what it sends or its name."""
        return self.moves_hardware(node) and not self.is_called_sensor(node)

    def is_controller(self, node: str) -> bool:
        """Return whether a node is a controller of ros2_control, whose program is a plugin."""
        return node in self.app.nodes and "/" in self.app.nodes[node].executable

    def is_called_driver(self, node: str) -> bool:
        """Return whether a node opens hardware, or is called like what does."""
        return node in self.with_device or moves(node, self.package(node))

    def may_obey(self, node: str) -> bool:
        """Return whether a node moves something, or may: it is called so, or was not read."""
        is_unread = node in self.app.unread_nodes
        return self.drives(node) or self.is_called_driver(node) or is_unread

    def may_drive(self, node: str) -> bool:
        """Return whether a node drives, or tells where something moved to, or was not read."""
        types = self._sent_types.get(node, frozenset())
        is_unread = node in self.app.unread_nodes
        return self.drives(node) or is_unread or not types.isdisjoint(_MOVED)


def may_drive_unread(node: Node) -> bool:
    """Return whether the names of a node that was not read leave open that it drives something."""
    only_listens = _has_word(node, _LISTENERS) and not moves(node.name, node.package)
    is_stop = EMERGENCY_STOP.match(snake_case(node.name.rpartition("/")[2]))
    return not (only_listens or is_stop or is_called_sensor(node))


def unread_drivers(app: AppFacts) -> list[str]:
    """Return the nodes that were not read and are called like drivers, but those for others."""
    others = carriers(app)
    nodes = (app.nodes[name] for name in app.unread_nodes if name not in others)
    return [n.name for n in nodes if moves(n.name, n.package) and may_drive_unread(n)]


def measured_topics(app: AppFacts) -> frozenset[str]:
    """Return the topics that look like commands of motion and command nothing."""
    return frozenset(filter(NodeRoles(app).only_measures, app.motion_topics))


def _has_word(node: Node, pattern: re.Pattern[str]) -> bool:
    words = re.split(r"[_\-\s]+", f"{node.name.rpartition('/')[2]} {node.package}".lower())
    return any(map(pattern.fullmatch, words))

"""The guard's nodes in ROS 1, those of the bulk process and those of the command process."""

from collections.abc import Callable

from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.lanes.command_lane import CommandLane


class JoinedNodes:
    """All nodes of the guard, for the audit in the bulk process; see `GuardNodes`."""

    def __init__(self, own: GuardNodes, lane: CommandLane) -> None:
        self._own = own
        self._lane = lane

    @property
    def on_subscriber(self) -> Callable[[str, str], None]:
        """Called with a topic of ours and the name of a node that has begun to listen to it."""
        return self._own.on_subscriber

    @on_subscriber.setter
    def on_subscriber(self, handler: Callable[[str, str], None]) -> None:
        self._own.on_subscriber = self._lane.on_subscriber = handler

    @property
    def on_shutdown_request(self) -> Callable[[str, str], None]:
        """Called with a node that others shut down, and why."""
        return self._own.on_shutdown_request

    @property
    def ports(self) -> frozenset[int]:
        """The TCPROS ports of all nodes."""
        return self._own.ports | {self._lane.nodes.port} - {0}

    def node_uris(self) -> dict[str, str]:
        """Return the URI of each node."""
        return self._own.node_uris() | dict(self._lane.nodes.uris)

    def former_uris(self) -> frozenset[str]:
        """Return the URIs of the nodes of the command process before this one."""
        return self._lane.former_uris

    def subscribers(self, topic: str) -> set[str]:
        """Return the names that the connected subscribers of a topic give themselves."""
        return self._own.subscribers(topic) | self._lane.nodes.subscribers.get(topic, frozenset())

    def register_node(self, name: str) -> None:
        """Register a node again: the master gives a name to the last one that registers it."""
        if name in self._lane.nodes.uris:
            self._lane.register_node(name)
        else:
            self._own.register_node(name)

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Call `handler` with a node that others shut down, and why."""
        self._own.set_shutdown_handler(handler)
        self._lane.on_shutdown_request = handler

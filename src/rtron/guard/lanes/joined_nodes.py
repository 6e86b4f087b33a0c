"""The guard's nodes in ROS 1, those of the bulk process and those of the command process."""

from collections.abc import Callable

from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.lanes.bulk_connection import BulkConnection
from rtron.guard.lanes.messages import RegisterNode


class JoinedNodes:
    """All nodes of the guard, for the audit in the command process; see `GuardNodes`."""

    def __init__(self, own: GuardNodes, bulk: BulkConnection) -> None:
        self._own = own
        self._bulk = bulk

    @property
    def on_subscriber(self) -> Callable[[str, str], None]:
        """Called with a topic of ours and the name of a node that has begun to listen to it."""
        return self._own.on_subscriber

    @on_subscriber.setter
    def on_subscriber(self, handler: Callable[[str, str], None]) -> None:
        self._own.on_subscriber = self._bulk.on_subscriber = handler

    @property
    def on_subscriber_lost(self) -> Callable[[str, str], None]:
        """Called with a topic of ours and the name of a node that has ceased to listen to it."""
        return self._own.on_subscriber_lost

    @on_subscriber_lost.setter
    def on_subscriber_lost(self, handler: Callable[[str, str], None]) -> None:
        self._own.on_subscriber_lost = self._bulk.on_subscriber_lost = handler

    @property
    def on_shutdown_request(self) -> Callable[[str, str], None]:
        """Called with a node that others shut down, and why."""
        return self._own.on_shutdown_request

    @property
    def ports(self) -> frozenset[int]:
        """The TCPROS ports of all nodes."""
        return self._own.ports | {self._bulk.nodes.port} - {0}

    def unknown_streams(self) -> frozenset[str]:
        """Return the bulk process's streams until it has told its nodes."""
        return self._bulk.unknown_streams()

    def node_uris(self) -> dict[str, str]:
        """Return the URI of each node."""
        return self._own.node_uris() | dict(self._bulk.nodes.uris)

    def former_uris(self) -> frozenset[str]:
        """Return the URIs of the nodes of the bulk process before this one."""
        return self._bulk.former_uris

    def subscribers(self, topic: str) -> set[str]:
        """Return the names that the connected subscribers of a topic give themselves."""
        return self._own.subscribers(topic) | self._bulk.nodes.subscribers.get(topic, frozenset())

    def register_node(self, name: str) -> None:
        """Register a node again: the master gives a name to the last one that registers it."""
        if name in self._bulk.nodes.uris:
            self._bulk.send(RegisterNode(name))
        else:
            self._own.register_node(name)

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Call `handler` with a node that others shut down, and why."""
        self._own.set_shutdown_handler(handler)
        self._bulk.on_shutdown_request = handler

"""The guard's nodes in ROS 1, those of the command process and those of the bulk process."""

from collections.abc import Callable

from rtron.guard.audit.ros1.guard_nodes import GuardNodes
from rtron.guard.lanes.bulk.command_nodes import CommandNodes


class JoinedNodes:
    """All nodes of the guard, for the audit in the bulk process; see `GuardNodes`."""

    def __init__(self, own: GuardNodes, commands: CommandNodes) -> None:
        self._own = own
        self._commands = commands

    @property
    def on_subscriber(self) -> Callable[[str, str], None]:
        """Called with a topic of ours and the name of a node that has begun to listen to it."""
        return self._own.on_subscriber

    @on_subscriber.setter
    def on_subscriber(self, handler: Callable[[str, str], None]) -> None:
        self._own.on_subscriber = self._commands.on_subscriber = handler

    @property
    def on_subscriber_lost(self) -> Callable[[str, str], None]:
        """Called with a topic of ours and the name of a node that has ceased to listen to it."""
        return self._own.on_subscriber_lost

    @on_subscriber_lost.setter
    def on_subscriber_lost(self, handler: Callable[[str, str], None]) -> None:
        self._own.on_subscriber_lost = self._commands.on_subscriber_lost = handler

    @property
    def ports(self) -> frozenset[int]:
        """The TCPROS ports of all nodes."""
        return self._own.ports | {self._commands.report.port} - {0}

    def unknown_streams(self) -> frozenset[str]:
        """Return the command process's streams until it has told its nodes."""
        return self._commands.unknown_streams()

    def node_uris(self) -> dict[str, str]:
        """Return the URI of each node."""
        return self._own.node_uris() | dict(self._commands.report.uris)

    def former_uris(self) -> frozenset[str]:
        """Return the URIs of the nodes of the command process before this one."""
        return self._commands.former_uris

    def subscribers(self, topic: str) -> set[str]:
        """Return the names that the connected subscribers of a topic give themselves."""
        others = self._commands.report.subscribers.get(topic, frozenset())
        return self._own.subscribers(topic) | others

    def register_node(self, name: str) -> None:
        """Register a node again: the master gives a name to the last one that registers it."""
        if name in self._commands.report.uris:
            self._commands.register_node(name)
        else:
            self._own.register_node(name)

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Call `handler` with a node that others shut down, and why."""
        self._own.set_shutdown_handler(handler)
        self._commands.on_shutdown_request = handler

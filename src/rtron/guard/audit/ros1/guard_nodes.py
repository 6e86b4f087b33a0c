"""The guard's nodes in ROS 1, those of the command process and those of the bulk process."""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtron.guard.lanes.bulk.command_nodes import CommandNodes
    from rtron.guard.transport.ros1.middleware import Ros1Transport


class GuardNodes:
    """All nodes of the guard, as the audit needs to know them; a dry run has but its own."""

    def __init__(self, own: "Ros1Transport", commands: "CommandNodes") -> None:
        self._own = own
        self._commands = commands

    def set_listener_handlers(
        self, on_new: Callable[[str, str], None], on_lost: Callable[[str, str], None]
    ) -> None:
        """Call these with a topic of ours and who has begun or ceased to listen to it."""
        self._own.on_subscriber = self._commands.on_subscriber = on_new
        self._own.on_subscriber_lost = self._commands.on_subscriber_lost = on_lost

    @property
    def ports(self) -> frozenset[int]:
        """The TCPROS ports of all nodes."""
        return frozenset({self._own.port, self._commands.report.port} - {0})

    def unknown_streams(self) -> frozenset[str]:
        """Return the streams whose nodes of ours are not known at this moment."""
        return self._commands.unknown_streams()

    def node_uris(self) -> dict[str, str]:
        """Return the URI of each node."""
        return self._own.node_uris() | dict(self._commands.report.uris)

    def former_uris(self) -> frozenset[str]:
        """Return the URIs of nodes of ours that have ended; subscribers may still have them."""
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

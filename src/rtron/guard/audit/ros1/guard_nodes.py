"""The guard's own nodes in ROS 1, as the audit needs to know them."""

from collections.abc import Callable
from typing import Protocol


class GuardNodes(Protocol):
    """All nodes of the guard, in however many processes."""

    on_subscriber: Callable[[str, str], None]
    """Called with a topic of ours and the name of a node that has begun to listen to it."""
    on_subscriber_lost: Callable[[str, str], None]
    """Called with a topic of ours and the name of a node that has ceased to listen to it."""

    @property
    def ports(self) -> frozenset[int]:
        """The TCPROS ports of all nodes."""
        ...

    def unknown_streams(self) -> frozenset[str]:
        """Return the streams whose nodes of ours are not known at this moment."""
        ...

    def node_uris(self) -> dict[str, str]:
        """Return the URI of each node."""
        ...

    def former_uris(self) -> frozenset[str]:
        """Return the URIs of nodes of ours that have ended; subscribers may still have them."""
        ...

    def subscribers(self, topic: str) -> set[str]:
        """Return the names that the connected subscribers of a topic give themselves."""
        ...

    def register_node(self, name: str) -> None:
        """Register a node again: the master gives a name to the last one that registers it."""
        ...

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Call `handler` with a node that others shut down, and why."""
        ...

"""Whose an address is: the guard's own nodes by its own knowledge, others by the master's word."""

from collections.abc import Mapping

from rtron.guard.audit.ros1.bus_info import BusConnection, normalise_uri

_MAX_PUBLISHERS = 1024


class NodeAddresses:
    """The URIs of the guard's nodes and of planned publishers; URIs are compared as `normalise_uri`.

    `port` is the guard's TCPROS port: nobody else's messages can come from there. 0 if not known.
    """

    def __init__(self, guard_uris: Mapping[str, str], port: int = 0) -> None:
        self.guard_addresses = {normalise_uri(uri): node for node, uri in guard_uris.items()}
        self.port = port
        self._publishers: dict[str, str] = {}
        self._former_publishers: dict[str, str] = {}

    def node_of(self, connection: BusConnection) -> str:
        """Return whose connection it is, empty if nobody's who is known.

        A connection to our address that leads to another port is not ours: somebody took the
        address over.
        """
        node = self.guard_addresses.get(connection.source)
        if node is None:
            return self._publishers.get(connection.source, "")
        return node if connection.port in (None, 0, self.port) or not self.port else ""

    def learn(self, uri: str, node: str) -> None:
        """Take a planned publisher's address from the master; a name of our own is not learned."""
        if node in self.guard_addresses.values() or len(self._publishers) >= _MAX_PUBLISHERS:
            return
        for former in [known for known, name in self._publishers.items() if name == node]:
            self._former_publishers[former] = self._publishers.pop(former)
        self._former_publishers.pop(uri, None)
        self._publishers[uri] = node

    def address_of(self, node: str) -> str:
        """Return the address that was learned for a planned publisher, empty if none."""
        return next((uri for uri, name in self._publishers.items() if name == node), "")

    def is_former(self, uri: str) -> bool:
        """Tell whether a planned publisher has had this address before."""
        return uri in self._former_publishers

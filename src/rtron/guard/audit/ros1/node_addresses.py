"""Whose an address is: the guard's own nodes by its own knowledge, others by the master's word."""

from collections.abc import Mapping

from rtron.guard.audit.ros1.bus_info import Link, plain

_MOST = 1024


class Addresses:
    """The URIs of the guard's nodes and of planned publishers; URIs are compared as `plain`.

    `port` is the guard's TCPROS port: nobody else's messages can come from there. 0 if not known.
    """

    def __init__(self, own: Mapping[str, str], port: int = 0) -> None:
        self.own = {plain(uri): node for node, uri in own.items()}
        self.port = port
        self._others: dict[str, str] = {}
        self._former: dict[str, str] = {}

    def node_of(self, link: Link) -> str:
        """Return whose connection it is, empty if nobody's who is known.

        A connection to our address that leads to another port is not ours: somebody took the
        address over.
        """
        node = self.own.get(link.source)
        if node is None:
            return self._others.get(link.source, "")
        return node if link.port in (None, 0, self.port) or not self.port else ""

    def learn(self, uri: str, node: str) -> None:
        """Take a planned publisher's address from the master; a name of our own is not learned."""
        if node in self.own.values() or len(self._others) >= _MOST:
            return
        for other in [known for known, name in self._others.items() if name == node]:
            self._former[other] = self._others.pop(other)
        self._former.pop(uri, None)
        self._others[uri] = node

    def of(self, node: str) -> str:
        """Return the address that was learned for a planned publisher, empty if none."""
        return next((uri for uri, name in self._others.items() if name == node), "")

    def was(self, uri: str) -> bool:
        """Tell whether a planned publisher has had this address before."""
        return uri in self._former

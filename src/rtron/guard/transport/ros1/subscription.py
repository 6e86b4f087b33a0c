"""A topic that one of our nodes subscribes: a link to each publisher that the master lists."""

from collections.abc import Callable, Iterable

from rtron.guard.transport.ros1.publisher_link import PublisherLink


class Subscription:
    """Keeps one link a publisher; `joined` marks a connection between two nodes of the guard."""

    def __init__(
        self,
        topic: str,
        type: str,
        link: Callable[[str], PublisherLink],
        *,
        joined: bool = False,
    ) -> None:
        self.topic = topic
        self.type = type
        self.joined = joined
        self._link = link
        self.links: dict[str, PublisherLink] = {}
        self.own: tuple[str, ...] = ()

    def update(self, uris: Iterable[str], own: frozenset[str]) -> None:
        """Take the master's list of publishers; addresses of our own nodes are left out."""
        self._forget_closed()
        listed = set(uris)
        self.own = tuple(sorted(listed & own))
        wanted = set() if self.joined else listed - own
        for uri in self.links.keys() - wanted:
            if not self.links[uri].outlived:
                self.links.pop(uri).close()
        for uri in self.links.keys() & wanted:
            self.links[uri].outlived = False
        for uri in wanted - self.links.keys():
            self.links[uri] = self._link(uri)

    def outlive_master(self) -> None:
        """Keep the links that work although a new master knows nothing of them, as ROS does."""
        for link in self.links.values():
            link.outlived = link.connected

    def _forget_closed(self) -> None:
        self.links = {uri: link for uri, link in self.links.items() if not link.is_closed}

    def close(self) -> None:
        """Close every link."""
        for link in self.links.values():
            link.close()
        self.links.clear()

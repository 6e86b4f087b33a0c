"""A topic that one of our nodes subscribes: a link to each publisher that the master lists."""

from collections.abc import Callable, Iterable

from rtron.guard.transport.ros1.publisher_link import PublisherLink


class Subscription:
    """Keeps one link a publisher; `is_internal` marks a connection between two nodes of the guard."""

    def __init__(
        self,
        topic: str,
        type: str,
        create_link: Callable[[str], PublisherLink],
        *,
        is_internal: bool = False,
    ) -> None:
        self.topic = topic
        self.type = type
        self.is_internal = is_internal
        self._create_link = create_link
        self.links: dict[str, PublisherLink] = {}
        self.own_uris: tuple[str, ...] = ()

    def update(self, uris: Iterable[str], own_uris: frozenset[str]) -> None:
        """Take the master's list of publishers; addresses of our own nodes are left out."""
        self._forget_closed()
        listed_uris = set(uris)
        self.own_uris = tuple(sorted(listed_uris & own_uris))
        expected_uris = set() if self.is_internal else listed_uris - own_uris
        for uri in self.links.keys() - expected_uris:
            if not self.links[uri].is_from_old_master:
                self.links.pop(uri).close()
        for uri in self.links.keys() & expected_uris:
            self.links[uri].is_from_old_master = False
        for uri in expected_uris - self.links.keys():
            self.links[uri] = self._create_link(uri)

    def keep_working_links(self) -> None:
        """Keep the links that work although a new master knows nothing of them, as ROS does."""
        for link in self.links.values():
            link.is_from_old_master = link.is_connected

    def _forget_closed(self) -> None:
        self.links = {uri: link for uri, link in self.links.items() if not link.is_closed}

    def close(self) -> None:
        """Close every link."""
        for link in self.links.values():
            link.close()
        self.links.clear()

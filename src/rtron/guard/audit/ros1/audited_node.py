"""One guarded node as the audit sees it: where it lives, what it said last, and since when not."""

from dataclasses import dataclass, field, replace

from rtron.guard.audit.ros1.bus_info import Link
from rtron.guard.audit.ros1.foreign_connections import Stranger
from rtron.guard.audit.ros1.poll_schedule import Asked
from rtron.guard.audit.ros1.xmlrpc_poller import Asker, request
from rtron.vocabulary import GUARD_NODE, SECOND, PlannedTopic

_QUESTION = request("getBusInfo", GUARD_NODE)
_FIRST_RETRY, _LAST_RETRY = SECOND // 10, 2 * SECOND
_SHARE = 20


@dataclass(slots=True, kw_only=True, eq=False)
class GuardedNode:
    """A node that hears the guard; `heard` are the topics on which it matters whom it hears.

    `body` is the answer that `links` were read from, `first` what the first answer from where the
    node lives now told, None before there is one; its links have no ports. `seen` is when it last
    answered well (ns), `fault` why it does not; `refused` tells that nothing listens at its
    address.
    """

    name: str
    heard: dict[str, PlannedTopic]
    asked: Asked
    seen: int
    body: bytes = b""
    links: frozenset[Link] = frozenset()
    first: frozenset[Link] | None = None
    strangers: frozenset[Stranger] = frozenset()
    fault: str = "the master does not tell where it lives"
    refused: bool = False
    reading: bool = False
    looking: bool = False
    _retry: int = field(default=_FIRST_RETRY)

    def answered_well(self, now: int) -> None:
        """Note that the node has answered, and how."""
        self.seen, self.fault, self.refused = now, "", False
        self._retry = _FIRST_RETRY

    def said(self, links: frozenset[Link]) -> None:
        """Keep what the first answer told."""
        if self.first is None:
            self.first = frozenset(replace(link, port=None) for link in links)

    def failed(self, why: str, now: int, *, refused: bool = False) -> None:
        """Note that it has not; it is asked again after a while, each time a longer one."""
        self.fault, self.refused = why, refused
        self.asked.not_before = now + self._retry
        self._retry = min(2 * self._retry, _LAST_RETRY)

    def took(self, work: int, now: int) -> None:
        """Ask the node less often if its answers are much work (ns): a twentieth of the time."""
        self.asked.not_before = max(self.asked.not_before, now + _SHARE * work)

    def moved(self) -> None:
        """Ask at another address at once."""
        self.asked.asker.close()
        self.asked.not_before = 0
        self.body = b""
        self.first = None


def asker() -> Asker:
    """Return what asks a node for its connections."""
    return Asker(_QUESTION)

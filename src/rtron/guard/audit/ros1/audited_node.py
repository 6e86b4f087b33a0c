"""One guarded node as the audit sees it: where it lives, what it said last, and since when not."""

from dataclasses import dataclass, field, replace

from rtron.guard.audit.ros1.bus_info import BusConnection
from rtron.guard.audit.ros1.foreign_connections import ForeignConnection
from rtron.guard.audit.ros1.poll_schedule import PollTarget
from rtron.guard.audit.ros1.xmlrpc_poller import XmlRpcPoller, encode_call
from rtron.vocabulary import GUARD_NODE, SECOND, TopicAccess

_REQUEST = encode_call("getBusInfo", GUARD_NODE)
_FIRST_RETRY, _LAST_RETRY = SECOND // 10, 2 * SECOND
_SHARE = 20


@dataclass(slots=True, kw_only=True, eq=False)
class AuditedNode:
    """A node that hears the guard; `audited_topics` are the topics on which it matters whom it hears.

    `last_body` is the answer that `connections` were read from, `first_connections` what the first answer from where the
    node lives now told, None before there is one; its links have no ports. `last_response_at` is when it last
    answered well (ns), `failure` why it does not; `is_refused` tells that nothing listens at its
    address.
    """

    name: str
    audited_topics: dict[str, TopicAccess]
    poll_target: PollTarget
    last_response_at: int
    last_body: bytes = b""
    connections: frozenset[BusConnection] = frozenset()
    first_connections: frozenset[BusConnection] | None = None
    foreign_connections: frozenset[ForeignConnection] = frozenset()
    failure: str = "the master does not tell where it lives"
    is_refused: bool = False
    is_parsing: bool = False
    is_resolving: bool = False
    _retry_delay: int = field(default=_FIRST_RETRY)

    def note_success(self, now: int) -> None:
        """Note that the node has answered, and how."""
        self.last_response_at, self.failure, self.is_refused = now, "", False
        self._retry_delay = _FIRST_RETRY

    def note_first_connections(self, connections: frozenset[BusConnection]) -> None:
        """Keep what the first answer told."""
        if self.first_connections is None:
            self.first_connections = frozenset(replace(link, port=None) for link in connections)

    def note_failure(self, failure: str, now: int, *, is_refused: bool = False) -> None:
        """Note that it has not; it is asked again after a while, each time a longer one."""
        self.failure, self.is_refused = failure, is_refused
        self.poll_target.not_before = now + self._retry_delay
        self._retry_delay = min(2 * self._retry_delay, _LAST_RETRY)

    def limit_rate(self, work: int, now: int) -> None:
        """Ask the node less often if its answers are much work (ns): a twentieth of the time."""
        self.poll_target.not_before = max(self.poll_target.not_before, now + _SHARE * work)

    def reset_address(self) -> None:
        """Ask at another address at once."""
        self.poll_target.poller.close()
        self.poll_target.not_before = 0
        self.last_body = b""
        self.first_connections = None


def bus_info_poller() -> XmlRpcPoller:
    """Return what asks a node for its connections."""
    return XmlRpcPoller(_REQUEST)

"""The nodes of the command process, for the audit in the bulk process."""

from collections import deque
from functools import partial
from typing import TYPE_CHECKING

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.exchange.audit_exchange import NodesReport
from rtron.guard.lanes.exchange.process_connection import ProcessConnection
from rtron.guard.transport.ros2.participants import MAX_LEASE

if TYPE_CHECKING:
    from collections.abc import Callable

_MAX_FORMER = 8


class CommandNodes:
    """What the command process tells of its nodes, and what is left of the one before."""

    def __init__(
        self, connection: ProcessConnection, loop: EventLoop, streams: frozenset[str]
    ) -> None:
        """`streams` are the public names of those that the command process carries."""
        self.report = NodesReport()
        self.former_uris: frozenset[str] = frozenset()
        """The URIs that the nodes of the command process before had (ROS 1)."""
        self.on_subscriber: Callable[[str, str], None] = _ignore
        self.on_subscriber_lost: Callable[[str, str], None] = _ignore
        self.on_shutdown_request: Callable[[str, str], None] = _ignore
        self.on_change: Callable[[], None] = lambda: None
        """Called when a command process has told other nodes than before."""
        self.register_node = partial(connection.call, "register_node")
        self._loop = loop
        self._streams = streams
        self._has_reported = False
        self._former_participants: deque[tuple[bytes, int]] = deque(maxlen=_MAX_FORMER)
        connection.on(
            nodes=self._take_report,
            subscribed=lambda *node: self.on_subscriber(*node),  # noqa: PLW0108 - set later
            unsubscribed=lambda *node: self.on_subscriber_lost(*node),  # noqa: PLW0108
            shutdown_request=lambda *why: self.on_shutdown_request(*why),  # noqa: PLW0108
        )
        connection.loss_listeners.append(self._on_lost)

    def participants(self) -> frozenset[bytes]:
        """Return its participant in the graph of ROS 2, and those of processes before it.

        These count only as long as a dead participant may stay in the graph.
        """
        since = self._loop.now() - MAX_LEASE
        former = {each for each, lost_at in self._former_participants if lost_at > since}
        present = {self.report.participant} - {b""}
        return frozenset(present | former | self.report.former_participants)

    def unknown_streams(self) -> frozenset[str]:
        """Return its streams, until it has told its nodes."""
        return frozenset() if self._has_reported else self._streams

    def _take_report(self, report: NodesReport) -> None:
        is_new = not self._has_reported or report.uris != self.report.uris
        self.report, self._has_reported = report, True
        if is_new:
            self.on_change()

    def _on_lost(self) -> None:
        if not self._has_reported:
            return
        self._has_reported = False
        self.former_uris = frozenset(self.report.uris.values())
        lost_at = self._loop.now()
        participants = (self.report.participant, *self.report.former_participants)
        self._former_participants.extend((each, lost_at) for each in participants if each)
        self.report = NodesReport()


def _ignore(_topic: str, _node: str) -> None:
    """Do nothing."""

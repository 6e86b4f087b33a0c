"""What the command process tells the audit in the bulk process about its nodes."""

from collections.abc import Callable
from dataclasses import replace

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.bulk_connection import BulkConnection
from rtron.guard.lanes.messages import LostListener, NewListener, ShutdownRequest
from rtron.guard.middleware import Middleware
from rtron.guard.node_shutdown import ShutdownRefusal
from rtron.vocabulary import SECOND


class NodeReports:
    """Tells the nodes at each connection and once a second, and what happens to them at once."""

    def __init__(
        self,
        connection: BulkConnection,
        middleware: Middleware,
        loop: EventLoop,
        supervisor: Callable[[], int],
    ) -> None:
        """`supervisor` tells the process id of the supervisor."""
        self._connection = connection
        self._middleware = middleware
        self._loop = loop
        self._supervisor = supervisor
        self._refusal = ShutdownRefusal(loop)
        connection.connect_listeners.append(self._report)

    def open(self) -> None:
        """Report from now on."""
        send = self._connection.send
        self._middleware.set_listener_handlers(
            lambda topic, node: send(NewListener(topic, node)),
            lambda topic, node: send(LostListener(topic, node)),
        )
        self._middleware.transport.set_shutdown_handler(self._on_shutdown_request)
        self._report_periodically()

    def close(self) -> None:
        """Report no more; the connection ends with the process."""

    def _report_periodically(self) -> None:
        self._loop.call_at(self._loop.now() + SECOND, self._report_periodically)
        self._report()

    def _report(self) -> None:
        report = self._middleware.report_nodes()
        former = report.former_participants | self._connection.former_participants()
        supervisor = self._supervisor()
        self._connection.send(replace(report, former_participants=former, supervisor=supervisor))

    def _on_shutdown_request(self, node: str, reason: str) -> None:
        """Let the audit deal with it; nobody ends this process over the network."""
        if self._connection.is_connected:
            self._connection.send(ShutdownRequest(node, reason))
        else:
            self._refusal.handle(node, reason)

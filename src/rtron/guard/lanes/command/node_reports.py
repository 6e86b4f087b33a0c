"""What the command process tells the audit in the bulk process about its nodes."""

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.lanes.command.bulk_connection import BulkConnection
from rtron.guard.middleware import Middleware
from rtron.guard.node_shutdown import ShutdownRefusal
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from rtron.guard.lanes.exchange.audit_exchange import NodesReport
    from rtron.guard.supervision.supervisor_client import SupervisorClient

log = logging.getLogger(__name__)

PERIOD = SECOND // 100
MAX_PER_PERIOD = 64
MAX_WAITING = 1024
MAX_TEXT = 256
"""How much is sent of what a stranger says, characters."""
Call = tuple[object, ...]
"""A call's name and its arguments."""


class NodeReports:
    """Tells the nodes at each connection, within a second of a change, and what happens to them."""

    def __init__(
        self,
        connection: BulkConnection,
        middleware: Middleware,
        loop: EventLoop,
        supervisor: "SupervisorClient",
    ) -> None:
        self._connection = connection
        self._middleware = middleware
        self._loop = loop
        self._supervisor = supervisor
        self._sender = RateLimitedSender(connection.send, loop)
        self._refusal = ShutdownRefusal(loop)
        self._last_report: NodesReport | None = None
        connection.connect_listeners.append(self._report_anew)
        connection.on(register_node=middleware.register_node)

    def open(self) -> None:
        """Report from now on."""
        send = self._sender.send
        self._middleware.set_listener_handlers(
            lambda topic, node: send(("subscribed", topic, node)),
            lambda topic, node: send(("unsubscribed", topic, node)),
        )
        self._middleware.transport.set_shutdown_handler(self._on_shutdown_request)
        self._report_periodically()

    def close(self) -> None:
        """Report no more; the connection ends with the process."""

    def _report_periodically(self) -> None:
        self._loop.call_at(self._loop.now() + SECOND, self._report_periodically)
        self._report()

    def _report_anew(self) -> None:
        self._last_report = None
        self._report()

    def _report(self) -> None:
        report = self._middleware.report_nodes()
        former = report.former_participants | self._connection.former_participants()
        report = replace(
            report,
            former_participants=former,
            supervisor_participant=self._supervisor.supervisor_participant(),
        )
        if report != self._last_report:
            self._last_report = report
            self._connection.call("nodes", report)

    def _on_shutdown_request(self, node: str, reason: str) -> None:
        """Let the audit deal with it; nobody ends this process over the network."""
        if self._connection.is_connected:
            self._sender.send(("shutdown_request", node[:MAX_TEXT], reason[:MAX_TEXT]))
        else:
            self._refusal.handle(node, reason)


class RateLimitedSender:
    """Sends a message at once, but equal ones once a period, and few in all: strangers cause them.

    What has to wait is sent when the period ends. A message without room is lost.
    """

    def __init__(self, send: Callable[[Call], None], loop: EventLoop) -> None:
        self._send = send
        self._loop = loop
        self._sent: set[Call] = set()
        """What was sent in this period, which has ended if this is empty."""
        self._waiting: dict[Call, None] = {}
        self._lost_count = 0
        self._log_throttle = LogThrottle()

    def send(self, message: Call) -> None:
        """Send a message, now or when it is due."""
        if message not in self._sent and len(self._sent) < MAX_PER_PERIOD:
            self._send_now(message)
        elif message in self._waiting or len(self._waiting) < MAX_WAITING:
            self._waiting[message] = None
        else:
            self._count_lost()

    def _send_now(self, message: Call) -> None:
        if not self._sent:
            self._loop.call_at(self._loop.now() + PERIOD, self._begin_period)
        self._sent.add(message)
        self._send(message)

    def _begin_period(self) -> None:
        self._sent.clear()
        for message in list(self._waiting)[:MAX_PER_PERIOD]:
            del self._waiting[message]
            self._send_now(message)

    def _count_lost(self) -> None:
        self._lost_count += 1
        if self._log_throttle.allows("lost", self._loop.now()):
            text = "%d messages to the audit were lost: nodes connect and disconnect too fast"
            log.warning(text, self._lost_count)

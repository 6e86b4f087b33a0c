"""What the bulk process tells the audit in the command process about its nodes."""

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command_lane import CommandLane
from rtron.guard.lanes.messages import LostListener, NewListener, ShutdownRequest
from rtron.guard.middleware import Middleware
from rtron.guard.node_shutdown import ShutdownRefusal
from rtron.vocabulary import SECOND


class NodeReports:
    """Tells the nodes at each connection and once a second, and what happens to them at once."""

    def __init__(self, lane: CommandLane, middleware: Middleware, loop: EventLoop) -> None:
        self._lane = lane
        self._middleware = middleware
        self._loop = loop
        self._refusal = ShutdownRefusal(loop)
        lane.connect_listeners.append(self._report)

    def open(self) -> None:
        """Report from now on."""
        send = self._lane.send
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
        self._lane.send(self._middleware.report_nodes())

    def _on_shutdown_request(self, node: str, reason: str) -> None:
        """Let the audit deal with it; nobody ends this process over the network."""
        if self._lane.is_connected:
            self._lane.send(ShutdownRequest(node, reason))
        else:
            self._refusal.handle(node, reason)

"""Running a bridge until it is told to end, and what persons say to the requests of its clients.

They say it beside the robot, or at the service.
"""

import logging
import os
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rtron.bridge.common.message_types import unknown_types
from rtron.bridge.known_types import known_types
from rtron.bridge.protocol.approvals import ApprovalRequest, Approvals
from rtron.bridge.rights.document import Approvers
from rtron.bridge.ros1.node import Ros1NodeFactory
from rtron.bridge.server.bridge import Bridge
from rtron.errors import WireError
from rtron.guard.core.control_socket import ControlSocket, Response, control_path
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.bridge_requests import LIST_REQUEST, bridge_link_path
from rtron.guard.settings.local_overrides import read_reason, single_line
from rtron.guard.system.process_attributes import allow_many_files
from rtron.guard.transport.factory import open_ros2_transport
from rtron.vocabulary import SECOND, OpenRequest, OpenRequests
from rtron.wire.common.link_protocol import ApprovalCommand, decode_approval_command

if TYPE_CHECKING:
    from rtron.bridge.common.client_node import NodeFactory
    from rtron.bridge.common.message_types import MessageTypes
    from rtron.bridge.rights.document import BridgeRights
    from rtron.vocabulary import Plan

_KEYS = {"approval", "number", "reason"}
log = logging.getLogger(__name__)
BRIDGE_NODE = "/rtron_bridge"
"""The bridge's own node in ROS 2, which has neither topics nor services."""


def run_bridge(plan: "Plan", rights: "BridgeRights", address: str, host: str, port: int) -> None:
    """Serve the clients of `rights` at `host`:`port` in the graph at an address, until SIGINT.

    SourceError if the port is taken, or ROS 2 cannot be joined.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    allow_many_files()
    loop = EventLoop()
    try:
        types, nodes = _join(plan, rights, address, loop)
        for problem in unknown_types(rights, plan.ros, types):
            log.warning("%s", problem)
        bridge = Bridge(loop, plan, rights, types, nodes)
        with closing(bridge), hearing_persons(loop, bridge.approvals, plan.app, rights):
            used = bridge.listen(host, port)
            count = len(rights.clients)
            log.info("the bridge listens at ws://%s:%d/ for %d clients", host, used, count)
            loop.run()
    except KeyboardInterrupt:
        log.info("told to end")
    finally:
        loop.close()


@contextmanager
def hearing_persons(
    loop: EventLoop, approvals: "Approvals", app: str, rights: "BridgeRights"
) -> Iterator[None]:
    """Hear persons beside the robot, and through the link process those at the service.

    That one speaks in the name of others, so at its socket not even root is heard.
    """
    beside = ApprovalCommands(approvals, loop.now)
    service = ServiceApprovals(approvals, rights.approvers, loop.now, time.time_ns)
    with ExitStack() as stack:
        for control in (
            ControlSocket(loop, bridge_control_path(app), beside.handle),
            ControlSocket(loop, bridge_link_path(app), service.handle, [os.getuid()]),
        ):
            stack.callback(control.close)
            control.open()
        yield


def bridge_control_path(app: str) -> Path:
    """Return where the bridge of an app listens for people."""
    return control_path(f"bridge_{app}")


def _join(
    plan: "Plan", rights: "BridgeRights", address: str, loop: EventLoop
) -> "tuple[MessageTypes, NodeFactory]":
    """Return the types that are known in the graph at an address, and what opens nodes there."""
    types = known_types(plan)
    if plan.ros == 1:
        return types, Ros1NodeFactory(loop, address, types, len(rights.clients))
    transport = open_ros2_transport(address, loop, node=BRIDGE_NODE)
    from rtron.bridge.ros2.node import Ros2NodeFactory  # noqa: PLC0415 - ROS 2 is not everywhere

    return types, Ros2NodeFactory(loop, transport, types)


class ApprovalCommands:
    """What a person beside the robot says to the requests of clients, at the control socket.

    Who may send there is the user that the bridge runs as, or root; no client reaches it.
    """

    def __init__(self, approvals: Approvals, now: Callable[[], int]) -> None:
        self._approvals = approvals
        self._now = now

    def handle(self, user: str, request: Mapping[str, Any]) -> Response:
        """Handle `{"approval": "list", "approve" or "refuse", "number": n, "reason": text}`.

        WireError if the request is wrong.
        """
        if set(request) != _KEYS or not isinstance(request["number"], int):
            raise WireError(f"a request has {', '.join(sorted(_KEYS))}")
        what, number = request["approval"], request["number"]
        if what == "list":
            now = self._now()
            shown = [_shown(each) for each in self._approvals.shown(now)]
            return {"requests": shown, "count": len(self._approvals.waiting(now))}
        if what not in ("approve", "refuse"):
            raise WireError("what to do with a request is list, approve or refuse")
        reason = read_reason(request["reason"])
        return {"answer": _answer(self._approvals, number, what, user, reason, self._now())}


class ServiceApprovals:
    """What persons at the service say, in the words of the link process of the guard.

    What they have seen is named by its digest, so a request that has changed is another one.
    """

    def __init__(
        self,
        approvals: Approvals,
        approvers: Approvers,
        now: Callable[[], int],
        wall: Callable[[], int],
    ) -> None:
        self._approvals, self._approvers = approvals, approvers
        self._now, self._wall = now, wall

    def handle(self, _user: str, request: Mapping[str, Any]) -> Response:
        """Handle `LIST_REQUEST`, or an `ApprovalCommand`; WireError for anything else."""
        if request == LIST_REQUEST:
            return asdict(self._open_requests())
        command = decode_approval_command(request)
        try:
            return {"granted": True, "reason": self._carry_out(command)}
        except WireError as error:
            return {"granted": False, "reason": str(error)}

    def _carry_out(self, command: ApprovalCommand) -> str:
        if not self._approvers.include(command.by, command.roles):
            raise WireError("the rights of the bridge let nobody with this name or role answer")
        reason = read_reason(command.reason)
        if not reason:
            raise WireError(f"to {command.do} a request needs a reason")
        found = self._approvals.find(command.digest, self._now())
        by = f"{single_line(command.by)} at the service"
        return _answer(self._approvals, found.number, command.do, by, reason, self._now())

    def _open_requests(self) -> OpenRequests:
        now = self._now()
        ahead = self._wall() - now
        return OpenRequests(
            count=len(self._approvals.waiting(now)),
            shown=tuple(
                OpenRequest(**_shown(each), digest=each.digest, until=_second(each.until + ahead))
                for each in self._approvals.shown(now)
            ),
            roles=self._approvers.roles,
            names=self._approvers.names,
        )


def _answer(approvals: Approvals, number: int, do: str, by: str, reason: str, now: int) -> str:
    """Approve or refuse a request, and log it; return what was done."""
    found = approvals.answer(number, by, now, is_approved=do == "approve")
    word = "approved" if found.is_approved else "refused"
    text = f"request {number} of {found.client}, {found.what}, is {word} by {by}"
    log.warning("%s: %s", text, reason or "no reason given")
    return text


def _second(time: int) -> int:
    """Return a time to the second, so that it is the same each time it is told."""
    return time // SECOND * SECOND


def _shown(request: ApprovalRequest) -> dict[str, Any]:
    return {
        "number": request.number,
        "client": request.client,
        "what": request.what,
        "content": request.content,
    }

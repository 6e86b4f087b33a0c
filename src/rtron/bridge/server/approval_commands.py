"""What persons say to the requests of the bridge's clients: beside the robot, or at the service."""

import logging
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from rtron.bridge.protocol.approvals import ApprovalRequest, Approvals
from rtron.bridge.rights.document import Approvers
from rtron.errors import WireError
from rtron.guard.core.control_socket import Response
from rtron.guard.link.bridge_requests import LIST_REQUEST
from rtron.guard.settings.local_overrides import read_reason, single_line
from rtron.vocabulary import SECOND, OpenRequest, OpenRequests
from rtron.wire.common.link_protocol import ApprovalCommand, decode_approval_command

log = logging.getLogger(__name__)

_KEYS = {"approval", "number", "reason"}


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

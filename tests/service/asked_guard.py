"""A guard with its link and a bridge in memory, connected to a service: the requests are real."""

import json
import time

from leased_guard import LeasedGuard

from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.rights.document import Approvers
from rtron.bridge.server.approval_commands import ServiceApprovals
from rtron.errors import WireError
from rtron.guard.link.bridge_requests import LIST_REQUEST
from rtron.wire.common.link_protocol import CommandResponse, decode_open_requests, encode_to_guard

GOAL = {"pose": {"position": {"x": 1, "y": 3}}}
APPROVERS = Approvers(roles=("end_user",), names=("dora",))


class AskedGuard(LeasedGuard):
    """Lets the bridge decide what persons answer, as its link would."""

    def __init__(self, port, headers, approvers=APPROVERS, **more):
        self.approvals = Approvals()
        self.passed = 0
        """So long its clock is ahead, ns."""
        self._service = ServiceApprovals(self.approvals, approvers, self.now, time.time_ns)
        super().__init__(port, headers, **{"takes_approval_commands": True} | more)
        self.answer = self._carry_out_approval

    def now(self):
        return time.monotonic_ns() + self.passed

    def requests(self):
        listed = self._service.handle("link", LIST_REQUEST)
        return decode_open_requests(json.dumps(listed).encode())

    def ask_person(self, content=GOAL, client="assistant", what="publish /goal"):
        """Let a client try to send something; return why not, or "" if it passes."""
        reason = ""
        try:
            self.approvals.check(client, what, content, self.now())
        except WireError as error:
            reason = str(error)
        self.tell_state()
        return reason

    def waiting(self):
        return [each.number for each in self.approvals.waiting(self.now())]

    def _carry_out_approval(self, command):
        answer = self._service.handle("link", json.loads(encode_to_guard(command)))
        return CommandResponse(number=command.number, **answer)

"""What a person beside the robot asks of leases and of the latched stop, at the control socket.

Who may send requests there stands above all ranks: it is the user that the guard runs as, or root.
"""

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

from rtron.errors import WireError, suggestion
from rtron.guard.authority.latched_stops import LatchedStops
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.core.control_socket import Response
from rtron.guard.settings.local_overrides import read_reason, single_line
from rtron.policies.authority.command_lease import CommandLease, LeaseAnswer, Person

_KEYS = {"lease", "do", "to", "reason"}


class LeaseCommands:
    """Lists the leases of a guard, gives them to commanders, and ends them."""

    def __init__(self, controller: LeaseController) -> None:
        self._controller = controller

    def handle(self, user: str, request: Mapping[str, Any]) -> Response:
        """Handle `{"lease": name, "do": "list", "give" or "end", "to": node, "reason": text}`.

        `list` returns all leases. WireError if the request is wrong or refused.
        """
        if set(request) != _KEYS or not isinstance(request["to"], str):
            raise WireError(f"a request has {', '.join(sorted(_KEYS))}")
        what, to, reason = request["do"], single_line(request["to"]), read_reason(request["reason"])
        if what == "list":
            return {"leases": [self._controller.describe(name) for name in self._controller.leases]}
        if what not in ("give", "end"):
            raise WireError("what to do with a lease is list, give or end")
        if not reason:
            raise WireError(f"to {what} a lease needs a reason")

        def ask(lease: CommandLease, now: int) -> LeaseAnswer:
            if what == "give":
                return lease.give(to, Person(user, None), now, reason)
            return lease.end(Person(user, None), now, reason)

        return self._request(request["lease"], f"{what} by {user}", ask)

    def _request(
        self, name: object, what: str, ask: Callable[[CommandLease, int], LeaseAnswer]
    ) -> Response:
        known = sorted(self._controller.leases)
        if name not in known:
            hint = suggestion(single_line(str(name)), known) if known else "the plan has none"
            raise WireError(f"no lease is called {single_line(str(name))!r}: {hint}")
        answer = self._controller.request(str(name), what, ask)
        if not answer.granted:
            raise WireError(answer.reason)
        return {"answer": answer.reason}


class StopCommands:
    """Stops the robot, and releases what a source has stopped."""

    def __init__(self, stops: LatchedStops) -> None:
        self._stops = stops

    def handle(self, user: str, request: Mapping[str, Any]) -> Response | Future[Response]:
        """Handle `{"stop": reason}`, or `{"release": source, "reason": text}`; "" lists them.

        A stop has effect at once; its response comes when the disk has it, or says that it has not.
        WireError if the request is wrong or refused; a stop is not refused for want of a reason.
        """
        if set(request) == {"stop"}:
            return self._stop(user, read_reason(request["stop"]) or "no reason given")
        if set(request) != {"release", "reason"} or not isinstance(request["release"], str):
            raise WireError("a request has stop, or release and reason")
        if request["release"]:
            source, reason = single_line(request["release"]), read_reason(request["reason"])
            answer = self._stops.release(source, user, reason)
            if not answer.released:
                raise WireError(answer.reason)
            return {"answer": answer.reason, "stops": self._stops.stops}
        return {"answer": "", "stops": self._stops.stops}

    def _stop(self, user: str, reason: str) -> Future[Response]:
        if not self._stops.has_effect:
            raise WireError("there is nothing to stop: a dry run, or a plan that only observes")
        self._stops.stop("robot", user, reason)
        response: Future[Response] = Future()

        def respond(unkept: str) -> None:
            note = f"; not yet kept for the time after a reboot: {unkept}" if unkept else ""
            answer = f"stopped by {user}: {reason}{note}"
            response.set_result({"answer": answer, "stops": self._stops.stops})

        self._stops.call_when_saved(respond)
        return response

"""What persons ask of a robot at once goes to its guard, or on to its bridge; that one decides.

Nothing of it is kept for later: a guard that is away hears nothing. What is sent is in the audit
log before, and the answer after.
"""

from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from secrets import randbits

from rtron.errors import RTronError, SourceError
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.audit_events import AuditEvent, lease_answer_event, request_answer_event
from rtron.service.domain.authority.leases import (
    LeaseChange,
    LeaseOutcome,
    LeaseView,
    RequestAnswer,
    RequestOutcome,
    RequestsView,
    check_answer,
    check_lease,
    lease_views,
    requests_view,
    seen_detail,
)
from rtron.service.domain.clock import Clock
from rtron.service.domain.errors import ConflictError
from rtron.service.domain.principal import Principal
from rtron.service.live.hub import Hub
from rtron.service.live.live_robots import LiveRobots
from rtron.service.store.audit import DONE, record_event, record_repeatable
from rtron.service.store.database import Database
from rtron.vocabulary import OpenRequests
from rtron.wire.common.link_protocol import (
    ApprovalCommand,
    CommandResponse,
    LeaseCommand,
    PersonCommand,
)

NUMBER_BITS = 52
"""A command has a random number of so many bits."""
_ANSWER_TIMEOUT_S = 3.0
_MAX_REASON = 1000
_REPEATED = frozenset({"lease.renew"})
"""Of what persons do again and again, the log has one entry for many."""

SendCommand = Callable[[str, PersonCommand], Future[CommandResponse]]
"""Lets another replica send a command to a robot's guard."""


class CommandDispatcher:
    """Sends commands of persons and waits for the answers. All may be called from any thread."""

    def __init__(self, database: Database, hub: Hub, clock: Clock) -> None:
        self.send_elsewhere: SendCommand | None = None
        self._database, self._hub, self._clock = database, hub, clock

    def record(self, event: AuditEvent, outcome: str = DONE) -> None:
        """Write into the audit log what a person asks for, or what came of it."""
        with self._database.write_session(durable=True, urgent=True) as session:
            if outcome == DONE and event.action not in _REPEATED:
                record_event(session, self._clock(), event)
            else:
                record_repeatable(session, self._clock(), event, outcome)

    def dispatch(self, robot: str, command: PersonCommand, answer: AuditEvent, look: str) -> str:
        """Send a command; return what was done. `answer` is the event of that.

        ConflictError with the reason if it is refused, and with the advice to `look`; SourceError
        if the guard is not connected, or does not answer in 3 s: then nobody knows whether it is
        done.
        """
        try:
            response = self._response(robot, command, look)
        except RTronError as error:
            self.record(answer, f"no answer: {error}")
            raise
        reason = response.reason[:_MAX_REASON].replace("\0", "\ufffd")  # as PostgreSQL takes it
        self.record(answer, f"{'granted' if response.granted else 'refused'}: {reason}")
        if not response.granted:
            raise ConflictError(reason, help=look)
        return reason

    def _response(self, robot: str, command: PersonCommand, look: str) -> CommandResponse:
        waiting = self._hub.send_command(robot, command)
        if waiting is None and self.send_elsewhere:
            waiting = self.send_elsewhere(robot, command)
        if waiting is None:
            raise SourceError(f"the guard of {robot} is not connected")
        try:
            return waiting.result(_ANSWER_TIMEOUT_S)
        except FutureTimeoutError:
            waiting.cancel()
            help = f"it may have done it all the same: {look}"
            raise SourceError(f"the guard of {robot} does not answer", help=help) from None


class LeaseDispatcher:
    """Shows leases and sends commands for them. All may be called from any thread."""

    def __init__(self, database: Database, live: LiveRobots, dispatcher: CommandDispatcher) -> None:
        self._database, self._live, self._dispatcher = database, live, dispatcher

    def views(self, robot: str, *, permitted: bool) -> list[LeaseView]:
        """Return who is in command of a robot; NotFoundError if it is not known."""
        with self._database.session() as session:
            plan = load_snapshot(session, robot).plan
            state = self._live.find(session, [robot])[robot].state
        return lease_views(plan, state, permitted=permitted)

    def change(
        self, caller: Principal, robot: str, lease: str, change: LeaseChange
    ) -> LeaseOutcome:
        """Have the guard do something with a lease.

        NotFoundError and ForbiddenError as the plan says; otherwise as `dispatch`.
        """
        detail = {"to": change.to, "reason": change.reason}
        event = caller.audit_event(f"lease.{change.do}", f"{robot}/{lease}", **detail)
        try:
            self._check(robot, lease)
        except RTronError as error:
            self._dispatcher.record(event, f"refused: {error}")
            raise
        self._dispatcher.record(event)
        command = LeaseCommand(
            number=randbits(NUMBER_BITS),
            lease=lease,
            do=change.do,
            by=caller.name,
            grant=change.grant,
            to=change.to,
            reason=change.reason,
        )
        answer = lease_answer_event(robot, event.target, change.do)
        look = "look who is in command now"
        return LeaseOutcome(reason=self._dispatcher.dispatch(robot, command, answer, look))

    def _check(self, robot: str, lease: str) -> None:
        with self._database.session() as session:
            check_lease(load_snapshot(session, robot).plan, lease)
            if not self._live.is_connected(session, robot):
                help = "who is in command can be said on the robot: rtron lease"
                raise SourceError(f"the guard of {robot} is not connected", help=help)


class RequestDispatcher:
    """Shows open requests and sends what persons answer. All may be called from any thread."""

    def __init__(self, database: Database, live: LiveRobots, dispatcher: CommandDispatcher) -> None:
        self._database, self._live, self._dispatcher = database, live, dispatcher

    def view(self, robot: str, caller: Principal, *, is_near: bool) -> RequestsView:
        """Return what waits at a robot; NotFoundError if it is not known.

        `is_near`: it is in a group of the caller.
        """
        return requests_view(self._find(robot), caller, is_near=is_near)

    def answer(
        self, caller: Principal, robot: str, digest: str, answer: RequestAnswer
    ) -> RequestOutcome:
        """Have the bridge approve or refuse a request.

        NotFoundError, ForbiddenError and ConflictError as the bridge has said last; otherwise as
        `dispatch`.
        """
        target = f"{robot}/{digest}"
        event = caller.audit_event(f"request.{answer.do}", target, reason=answer.reason)
        try:
            request = check_answer(self._find(robot), digest, caller)
        except RTronError as error:
            self._dispatcher.record(event, f"refused: {error}")
            raise
        seen = seen_detail(request)
        event = caller.audit_event(event.action, target, reason=answer.reason, **seen)
        self._dispatcher.record(event)
        command = ApprovalCommand(
            number=randbits(NUMBER_BITS),
            digest=digest,
            do=answer.do,
            by=caller.name,
            roles=tuple(sorted(caller.roles)),
            reason=answer.reason,
        )
        answered = request_answer_event(robot, target, answer.do)
        look = "look what waits now"
        return RequestOutcome(reason=self._dispatcher.dispatch(robot, command, answered, look))

    def _find(self, robot: str) -> OpenRequests | None:
        """Return what the bridge has told last; None if the robot or its bridge is away."""
        with self._database.session() as session:
            load_snapshot(session, robot)
            state = self._live.find(session, [robot])[robot].state
        return state.requests if state else None

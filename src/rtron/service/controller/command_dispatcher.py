"""What persons ask of a robot at once goes to its guard, or on to its bridge; that one decides.

Nothing of it is kept for later: a guard that is away hears nothing. What is sent is in the audit
log before, and the answer after.
"""

from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError

from rtron.errors import RTronError, SourceError
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock
from rtron.service.domain.errors import ConflictError
from rtron.service.live.hub import Hub
from rtron.service.store.audit import DONE, record_event, record_repeatable
from rtron.service.store.database import Database
from rtron.wire.common.link_protocol import CommandResponse, PersonCommand

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

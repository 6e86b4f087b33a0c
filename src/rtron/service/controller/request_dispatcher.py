"""What persons say to the requests of a bridge's clients goes to the bridge, which decides."""

from secrets import randbits

from rtron.errors import RTronError
from rtron.service.controller.command_dispatcher import NUMBER_BITS, CommandDispatcher
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.audit_events import request_answer_event
from rtron.service.domain.authority.requests import (
    RequestAnswer,
    RequestOutcome,
    RequestsView,
    check_answer,
    requests_view,
    seen_detail,
)
from rtron.service.domain.principal import Principal
from rtron.service.live.live_robots import LiveRobots
from rtron.service.store.database import Database
from rtron.vocabulary import OpenRequests
from rtron.wire.common.link_protocol import ApprovalCommand


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

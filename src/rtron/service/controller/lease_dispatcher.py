"""What persons say about who is in command goes to the robot's guard, which decides and answers."""

from secrets import randbits

from rtron.errors import RTronError, SourceError
from rtron.service.controller.command_dispatcher import NUMBER_BITS, CommandDispatcher
from rtron.service.controller.robot_snapshot import load_snapshot
from rtron.service.domain.audit_events import lease_answer_event
from rtron.service.domain.authority.leases import (
    LeaseChange,
    LeaseOutcome,
    LeaseView,
    check_lease,
    lease_views,
)
from rtron.service.domain.principal import Principal
from rtron.service.live.live_robots import LiveRobots
from rtron.service.store.database import Database
from rtron.wire.common.link_protocol import LeaseCommand


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

"""An action of ROS 2 as its server sees it: what it is asked, answers and tells, and loses."""

import logging
from functools import partial

from rtron.errors import WireError
from rtron.guard.action.common.stream import ActionStream
from rtron.guard.action.ros2.cancel_requests import Gatherings
from rtron.guard.action.ros2.client_replies import Desk
from rtron.guard.action.ros2.endpoints import Cancelled, CarriesRequests, Hears
from rtron.guard.action.ros2.results import KEPT_FOR, Result, Results
from rtron.guard.action.ros2.task import Task
from rtron.guard.core.handover_state import Will
from rtron.guard.core.observations import Senses
from rtron.guard.transport.common.protocol import Peer, Transport
from rtron.messages.ros2.actions import ABORTED, OVER, UNKNOWN, feedback_id, read_statuses
from rtron.policies.goals.registry import MOST_GOALS, Goal, Where
from rtron.policies.goals.status_list import LOST_AFTER, TERMINAL, compare
from rtron.vocabulary import SECOND, ActionEnd, Stream

log = logging.getLogger(__name__)

_ASK_AGAIN = SECOND
_IN_PROGRESS, _OVER = 1, min(TERMINAL)


class ServedRequests(ActionStream, Hears):
    """Follows what becomes of goals at the server; each is answered once, by it or by the guard.

    While others serve beside it, the server is in doubt: they get what is asked, and answers may be
    theirs. No goal is sent then, and one that runs is followed by what the server itself tells.
    Whether it is cancelled says the plan's `audit.on_foreign`, since the audit brakes: by default
    it is, because an intruder that answers in the place of the server could make a goal that moves
    the robot look as if it were over. Cancels are always sent: they can only make less move.
    """

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        senses: Senses,
        will: Will,
        requests: CarriesRequests,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, senses, will, dry_run=dry_run)
        self.server = self.doubt = ""
        self._ways = requests.action_ends(self.stream, self.nodes[0], self)
        self._tasks: dict[bytes, Task] = {}
        self._results = Results()
        self._desk = Desk(self._tasks.values, transport, partial(self._ways.tell, ActionEnd.STATUS))
        self._gatherings = Gatherings()
        self._incarnation = b""
        self._last_server = ""
        self._answered_alone: list[bytes] = []

    # What becomes of the server

    def server_came(self, node: str, incarnation: bytes) -> None:
        """Learn that the server is there; another than before knows none of the goals."""
        known = self._incarnation in (b"", incarnation)
        self.server = self._last_server = node
        self._incarnation = incarnation
        if self._halting:
            self.halted(node, self._halting)
        if known:
            self._cancel_answered()
        else:
            self._lose()
        self._answered_alone.clear()
        for task in list(self._tasks.values()):
            if task.accepted:
                self._ask_result(task)
            if task.goal.stopped:
                self._cancel_at_server(task.goal.id)
        self._desk.tell_soon()
        self._welcome()

    def server_left(self) -> None:
        """Learn that the server is not there any more."""
        log.warning("%s: the server %s is gone", self.name, self.server)
        now = self._transport.now()
        self.server, self._desk.listed = "", {}
        self._await_server(now)
        for goal in self.goals:
            if not goal.client:
                self._end(goal, now)
        self._transport.call_at(now + LOST_AFTER, self._answer_unfound)

    def server_doubted(self, why: str) -> None:
        """Send no goals while somebody else may take them; then go on."""
        self.doubt = why
        if self.server and not why:
            for task in list(self._tasks.values()):
                if task.accepted:
                    self._ask_result(task)
            self._welcome()

    def _free(self) -> None:
        """Let the next goal go, once it is certain to whom."""
        if self.doubt and not self.dry_run:
            self._absent = True
        else:
            super()._free()

    def _answer_unfound(self) -> None:
        """Answer the goals whose server has not been found again."""
        if not self.server:
            sent = (goal for goal in self.goals if goal.where is Where.SENT)
            self._answered_alone += [goal.id for goal in sent]
            del self._answered_alone[:-MOST_GOALS]
            self._lose()

    def _cancel_answered(self) -> None:
        """Cancel what was answered while the server was away: it may have gone on with it."""
        for id in self._answered_alone:
            self._cancel_at_server(id)

    def _lose(self) -> None:
        """Answer the goals that went with their server."""
        for task in list(self._tasks.values()):
            if task.goal.where is Where.SENT:
                self._finish(task, ABORTED, why="the server has lost it")
                self._turn_over(task.goal)

    # What it answers

    def _send(self, goal: Goal) -> None:
        task = self._tasks[goal.id]
        self.goals.send(goal, self._transport.now())
        self._bequest.keep()
        answered = partial(self._server_answered, task)
        if self._hears() or self.dry_run:
            self._ways.send_goal(goal.message, answered)  # type: ignore[arg-type]
        else:
            self._transport.call_at(self._transport.now(), partial(answered, None))

    def _server_answered(self, task: Task, stamp: int | None) -> None:
        """Take the server's answer to a goal."""
        if self._tasks.get(task.goal.id) is not task:
            if stamp is not None:
                self._cancel_at_server(task.goal.id)
        elif stamp is None:
            if self.doubt:
                self._cancel_at_server(task.goal.id)
            self._finish(task, ABORTED, why="the server has rejected it")
            self._turn_over(task.goal)
        elif not task.accepted:
            task.accepted = True
            task.admit(stamp)
            self._ask_result(task)
            if task.to_cancel:
                self._cancel_at_server(task.goal.id)
            self._desk.tell_soon()

    def _ask_result(self, task: Task) -> None:
        self._ways.get_result(task.goal.id, partial(self._result, task))

    def _await_result(self, goal: Goal, status: int) -> None:
        """Ask once more for the result of a goal that is over, then do without: it may be lost."""
        task, now = self._tasks.get(goal.id), self._transport.now()
        if task and not task.over:
            task.over = True
            self._transport.call_at(now + _ASK_AGAIN, partial(self._ask_again, task))
            self._transport.call_at(now + LOST_AFTER, partial(self._do_without, task, status))

    def _ask_again(self, task: Task) -> None:
        if self._tasks.get(task.goal.id) is task:
            self._ask_result(task)

    def _do_without(self, task: Task, status: int) -> None:
        if self._tasks.get(task.goal.id) is task:
            self._finish(task, status, why="its result does not come")

    def _result(self, task: Task, status: int, result: object) -> None:
        goal = task.goal
        if self._tasks.get(goal.id) is not task or not self._believes(goal, status):
            return
        if self.measured:
            self.measured.finished(goal.id, self._transport.now())
        if status == UNKNOWN:
            self._finish(task, ABORTED, why="the server has lost it")
        else:
            self._finish(task, status, result)
        self._turn_over(goal)

    def _believes(self, goal: Goal, status: int) -> bool:
        """Tell whether a result is the server's: in doubt, if the server itself has told the end.

        What is not believed is asked for once more, when the server has told or is alone again.
        """
        told = self._desk.listed.get(goal.id)
        return not self.doubt or (told is not None and told.status == status)

    def _cancel_at_server(self, id: bytes) -> None:
        """Ask the server to cancel a goal, be it in doubt or out of sight.

        One that it is about to answer is cancelled after that; in doubt at once, too, since that
        answer may be somebody else's.
        """
        task = self._tasks.get(id)
        is_coming = task is not None and not task.accepted
        if task and is_coming:
            task.to_cancel = True
        if not self.dry_run and (self.doubt or not is_coming):
            self._ways.cancel(id, 0, partial(self._cancel_told, id))

    def _cancel_told(self, id: bytes, cancelled: Cancelled) -> None:
        goal = self.goals.find(id)
        ends = any(each == id for each, _ in cancelled.goals)
        if goal and goal.stopped and not ends:
            log.error("%s: the server does not cancel %s", self.name, self._said(goal))
        self._gatherings.told(id, goal.stamp if goal else 0, ends=ends)

    # What it tells

    def server_told(self, end: ActionEnd, message: bytes) -> None:
        """Take what the server tells on its topics."""
        try:
            if end is ActionEnd.STATUS:
                self._status(message)
            else:
                self._feedback(message)
        except WireError as error:
            self._complain(Peer(self.server, self._ways.info), f"cannot be read: {error}")

    def _feedback(self, message: bytes) -> None:
        """Tell the goal's client; what overtakes the result comes after the goal is over."""
        id = feedback_id(message)
        goal = self.goals.find(id)
        flow = goal.flow if goal else self._results.flow(id)
        self._ways.tell(ActionEnd.FEEDBACK, message, [flow] if flow else [])

    def _status(self, message: bytes) -> None:
        now = self._transport.now()
        listed = {told.id: told for told in read_statuses(message)}
        self._desk.listed = listed if self.server else {}
        states = {id: _OVER if told.status in OVER else _IN_PROGRESS for id, told in listed.items()}
        news = compare(self.goals, states, now)
        for id in news.astray:
            self._cancel_at_server(id)
        for goal in news.found:
            self._found(goal, now)
        for goal in news.over:
            self._await_result(goal, listed[goal.id].status)
            if not goal.client:
                self._end(goal, now)
            self._turn_over(goal)
        for goal in self.goals:
            if not goal.client and states.get(goal.id, _OVER) == _OVER:
                self._end(goal, now)
                self._turn_over(goal)
        self._desk.tell()

    # How a goal ends

    def _finish(
        self, task: Task, status: int, result: object | None = None, *, why: str = ""
    ) -> None:
        """End a goal and answer its client; `why` says why the guard does, not the server."""
        goal, now = task.goal, self._transport.now()
        self._end(goal, now)
        self._bequest.keep_now()
        if why:
            log.info("%s: %s: %s", self.name, self._said(goal), why)
        if not task.known:
            task.reject()
            task.end(UNKNOWN, None)
            return
        kept = Result(goal.client, goal.flow, goal.stamp, status, result, now + KEPT_FOR)
        self._results.keep(goal.id, kept)
        task.end(status, result)
        if why:
            self._desk.ended(task, status)

    def _end(self, goal: Goal, now: int) -> None:
        self._tasks.pop(goal.id, None)
        self._gatherings.told(goal.id, goal.stamp, ends=False)
        super()._end(goal, now)

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        doubt = {"server in doubt": self.doubt} if self.doubt else {}
        return super().details | doubt

    def _why_refused(self, goal: Goal) -> str:
        in_doubt = self.server and self.doubt and not self.dry_run
        return self.doubt if in_doubt else super()._why_refused(goal)

    def _serving(self) -> str:
        """Return the server, also one out of sight: what it is to be kept from, it may go on to."""
        return self.server or self._last_server

    def _hears(self) -> bool:
        return bool(self.server) and not self.doubt

    def _serves(self) -> bool:
        return bool(self.server)

    def _said(self, goal: Goal) -> str:
        return f"goal {goal.id.hex()} of {goal.client or 'the server itself'}"

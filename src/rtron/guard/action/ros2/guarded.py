"""A guarded action of ROS 2: to its clients the guard is the server, to the server the client.

As with an action of ROS 1 a goal goes through a pipeline, one that waits is told as accepted, and
each goal is answered once. A cancel touches only the goals of the client that sends it.
"""

import logging
import time
from collections import defaultdict
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import WireError
from rtron.guard.action.bequest import Bequest
from rtron.guard.action.room import roomy
from rtron.guard.action.ros2.cancels import Gathering
from rtron.guard.action.ros2.desk import Desk
from rtron.guard.action.ros2.ends import (
    REJECTED,
    TERMINATED,
    UNKNOWN_GOAL,
    AnswerCancel,
    AnswerGoal,
    AnswerResult,
    Cancelled,
    CarriesRequests,
    GoalMessage,
)
from rtron.guard.action.ros2.places import Places
from rtron.guard.action.ros2.results import KEPT_FOR, Result, Results
from rtron.guard.action.ros2.task import Task
from rtron.guard.guarded import GuardedStream
from rtron.guard.seldom import Seldom
from rtron.guard.senses import Senses
from rtron.guard.transport.transport import Peer, Transport
from rtron.guard.will import Will
from rtron.messages.ros2_action import (
    ABORTED,
    CANCELED,
    NO_ID,
    OVER,
    UNKNOWN,
    feedback_id,
    read_statuses,
)
from rtron.policies.goals import MOST_GOALS, Goal, Goals, Where
from rtron.policies.listing import LOST_AFTER, TERMINAL, compare
from rtron.vocabulary import (
    SECOND,
    SERVER,
    UNAPPROVED,
    ActionEnd,
    Decision,
    Stream,
    Verdict,
    names_node,
)

if TYPE_CHECKING:
    from collections.abc import Callable

log = logging.getLogger(__name__)

_ORPHANED = 3 * SECOND
_FOUND_WITHIN = 10 * SECOND
_CANCEL_PATIENCE = 5 * SECOND
_ASK_AGAIN = SECOND
_LONGEST_NAME = 128
_MOST_STRANGERS = 32
_IN_PROGRESS, _OVER = 1, min(TERMINAL)


class RequestedAction(GuardedStream):
    """A guarded stream of goals that come as requests, with all else of the action beside it."""

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
        self.goals = Goals()
        self.server = ""
        self.halted: Callable[[str, str], None] = lambda node, why: None
        self.pipeline.gave_up = self._gave_up
        self._ways = requests.action_ends(self.stream, self.nodes[0], self)
        self._tasks: dict[bytes, Task] = {}
        self._results = Results()
        self._desk = Desk(self._tasks.values, transport, partial(self._ways.tell, ActionEnd.STATUS))
        self._gatherings: dict[bytes, list[Gathering]] = defaultdict(list)
        self._bequest = Bequest(self.name, self.goals, will, transport)
        self._places = Places(self.name, self._tasks, will, transport)
        self._most_waiting = stream.queue_size
        self._current: Goal | None = None
        self._incarnation = b""
        self._absent = False
        self._halting = ""
        self._seldom = Seldom()

    def open(self) -> None:
        """Join the graph."""
        self._info = self._ways.info
        self._ways.open()
        self._is_open = True
        for why in self._braked_by.values():
            self._hold(why)
        self._take_over()
        self.attend(self._transport.now())

    @property
    def name(self) -> str:
        """The action's name."""
        return self.stream.action

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        waiting = sum(goal.where is Where.WAITING for goal in self.goals)
        return {
            "goals": f"{waiting} waiting, {len(self.goals) - waiting} with the server",
            "server": self.server or "not there",
        }

    def attend(self, now: int) -> None:
        """Cancel what may not go on, and stop what it moves."""
        super().attend(now)
        for goal in () if self.dry_run else self.goals:
            if goal.where is Where.SENT and not goal.stopped:
                self._stop(goal, self._why_stopped(goal, now))
        self._halt()

    def _complete(self, stream: Stream) -> Stream:
        """Let the queue have room for every flow's share, which is bounded before it."""
        return roomy(super()._complete(stream))

    def _why_stopped(self, goal: Goal, now: int) -> str:
        """Return why a goal may not go on; one of the server's own unless all is stopped."""
        if goal.flow not in self.pipeline.tallies:
            return self.braked
        return self.pipeline.refusal(goal.flow, now, goal.message or None)

    def _stop(self, goal: Goal, why: str) -> None:
        goal.stopped = why
        if why:
            log.warning("%s: %s is cancelled: %s", self.name, _said(goal), why)
            self._cancel_at_server(goal.id)

    # What the guard before has left

    def _take_over(self) -> None:
        """Go on with the goals of the guard before; those that waited went with it."""
        now = self._transport.now()
        for goal in self.goals if self._bequest.take_over() else ():
            sent = goal.where is Where.SENT
            if goal.client:
                self._tasks[goal.id] = Task(goal, accepted=sent)
            if sent:
                self._current = goal
                self.pipeline.occupy(goal.flow, now)
        self._places.take_over(self._ways.place)
        self._transport.call_at(now + _ORPHANED, self._answer_orphans)
        self._transport.call_at(now + _FOUND_WITHIN, self._answer_unfound)

    def _answer_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended."""
        for task in list(self._tasks.values()):
            goal = task.goal
            if goal.client and goal.where is Where.WAITING and not goal.message:
                self._finish(task, ABORTED, why="the guard was restarted")

    def _answer_unfound(self) -> None:
        """Answer the goals of the guard before whose server has not been found."""
        if not self.server:
            self._lose()

    # What clients say

    def goal_asked(
        self, flow: str, peer: Peer, id: bytes, message: bytes, answer: AnswerGoal
    ) -> None:
        """Take a goal that was sent under the name of a flow."""
        now = self._transport.now()
        flow, client = self._caller(flow, peer)
        if self._shuts_out(flow):
            self._receive(flow, GoalMessage.of(id, message))
            answer(None)
        elif why := self._misfit() or self.goals.why_not(id, client, now):
            self._complain(peer, why)
            answer(None)
        else:
            goal = Goal(id, time.time_ns(), flow, client, GoalMessage.of(id, message), seen=now)
            self.goals.add(goal)
            task = self._tasks[id] = Task(goal, answer)
            self._decide(task)
            self._bequest.keep()

    def _caller(self, flow: str, peer: Peer) -> tuple[str, str]:
        """Return the flow that a request counts for, and what its client is called here."""
        named = next((each for each in self.stream.flows if each.name == flow), None)
        if named and peer.verified and names_node(named.publisher, peer.node):
            return flow, peer.node
        place = f"on the private name of {flow}" if named else "under the public name"
        name = peer.node[:_LONGEST_NAME]
        if self._seldom.may_say("stranger", self._transport.now()):
            log.warning("%s: unapproved client %s %s", self.name, name, place)
        if name in self.strangers or len(self.strangers) < _MOST_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        return UNAPPROVED, f"{UNAPPROVED} {peer.node}"

    def _shuts_out(self, flow: str) -> bool:
        return flow == UNAPPROVED and self.stream.block_unapproved and not self.dry_run

    def _misfit(self) -> str:
        """Return why no goal can be judged, or nothing."""
        fits = self.dry_run or self._md5sum in ("", self._ways.info.md5sum)
        told = "goals of this type are not what the plan's rules are written for"
        return "" if fits else told

    def _decide(self, task: Task) -> None:
        goal = task.goal
        if self.dry_run:
            self._send(goal)
        if why := self._why_refused(goal):
            self._finish(task, ABORTED, why=why)
            return
        verdict = self._receive(goal.flow, goal.message)
        if self.dry_run:
            return
        if verdict is None or verdict.decision is Decision.DROP:
            self._finish(task, ABORTED, why=verdict.reason if verdict else "internal error")
        elif verdict.decision is Decision.HOLD and goal.where is Where.WAITING:
            task.admit(goal.stamp)
            self._desk.tell_soon()

    def _why_refused(self, goal: Goal) -> str:
        """Return why a goal cannot be taken, whatever the policies say."""
        if self.dry_run:
            return ""
        if not self.server:
            return "the action server is not there"
        if len(self.goals) > MOST_GOALS:
            return f"{MOST_GOALS} goals are not over"
        full = self.goals.waiting(goal.flow) > self._most_waiting
        return f"{self._most_waiting} goals wait" if full else ""

    def _passed(self, flow: str, message: bytes, now: int) -> None:
        goal = self.goals.find(message.id) if isinstance(message, GoalMessage) else None
        self._current = goal or self._current
        super()._passed(flow, message, now)
        if goal is None:
            self._transport.call_at(now, partial(self._done, b""))
        elif not self.dry_run:
            self._send(goal)

    def _say(self, flow: str, message: bytes) -> None:
        """Say nothing on topics: goals are sent one by one."""

    def _send(self, goal: Goal) -> None:
        task = self._tasks[goal.id]
        self.goals.send(goal, self._transport.now())
        self._bequest.keep()
        answered = partial(self._server_answered, task)
        if self.server or self.dry_run:
            self._ways.send_goal(goal.message, answered)  # type: ignore[arg-type]
        else:
            self._transport.call_at(self._transport.now(), partial(answered, None))

    def _gave_up(self, message: bytes, verdict: Verdict) -> None:
        task = self._tasks.get(message.id) if isinstance(message, GoalMessage) else None
        if task and task.goal.where is Where.WAITING:
            status = CANCELED if task.cancelled else ABORTED
            self._finish(task, status, why=verdict.reason)

    def result_asked(self, flow: str, peer: Peer, id: bytes, answer: AnswerResult) -> None:
        """Take a request for a goal's result; nobody but its client gets it."""
        now = self._transport.now()
        _, client = self._caller(flow, peer)
        task = self._tasks.get(id)
        if task and task.goal.client == client:
            if task.wait(answer):
                self._places.keep()
            else:
                answer(UNKNOWN, None)
        elif kept := self._results.find(id, client, now):
            answer(kept.status, kept.result)
        else:
            answer(UNKNOWN, None)

    def cancel_asked(
        self, flow: str, peer: Peer, id: bytes, stamp: int, answer: AnswerCancel
    ) -> None:
        """Take a cancel: it means goals of the client that sends it, and no others."""
        flow, client = self._caller(flow, peer)
        if self.dry_run:
            self._ways.cancel(id, stamp, answer)
        elif self._shuts_out(flow):
            self._complain(peer, "not approved, its cancels are rejected")
            answer(Cancelled(REJECTED))
        else:
            self._cancel(client, id, stamp, answer)

    def _cancel(self, client: str, id: bytes, stamp: int, answer: AnswerCancel) -> None:
        now = self._transport.now()
        own = [task for task in self._tasks.values() if task.goal.client == client]
        meant = [task for task in own if _means(id, stamp, task)]
        if not meant and id != NO_ID:
            over = self._results.find(id, client, now)
            answer(Cancelled(TERMINATED if over else UNKNOWN_GOAL))
            return
        gathering = Gathering(answer)
        for task in meant:
            self._cancel_one(task, gathering, now)
        gathering.complete()
        self._transport.call_at(now + _CANCEL_PATIENCE, gathering.give_up)

    def _cancel_one(self, task: Task, gathering: Gathering, now: int) -> None:
        goal = task.goal
        if goal.where is Where.WAITING:
            task.cancelled = True
            gathering.ends(goal.id, goal.stamp)
            if goal.message:
                self.pipeline.withdraw(goal.message, "cancelled by its client", now)
            else:
                self._finish(task, CANCELED, why="cancelled by its client")
        else:
            gathering.await_(goal.id)
            self._gatherings[goal.id].append(gathering)
            self._cancel_at_server(goal.id)

    # What the server says

    def server_came(self, node: str, incarnation: bytes) -> None:
        """Learn that the server is there; another than before knows none of the goals."""
        known = self._incarnation in (b"", incarnation)
        self.server, self._incarnation = node, incarnation
        if not known:
            self._lose()
        for task in list(self._tasks.values()):
            if task.accepted:
                self._ask_result(task)
            if task.goal.stopped:
                self._cancel_at_server(task.goal.id)
        self._desk.tell_soon()
        if self._absent:
            self._absent = False
            if self._current is None:
                self._done(b"")

    def server_left(self) -> None:
        """Learn that the server is not there any more."""
        log.warning("%s: the server %s is gone", self.name, self.server)
        now = self._transport.now()
        self.server, self._desk.listed = "", {}
        self._absent, self._current = True, None
        self.pipeline.occupy(SERVER, now)
        for goal in self.goals:
            if not goal.client:
                self._end(goal, now)
        self._transport.call_at(now + LOST_AFTER, self._answer_unfound)

    def _lose(self) -> None:
        """Answer the goals that went with their server."""
        for task in list(self._tasks.values()):
            if task.goal.where is Where.SENT:
                self._finish(task, ABORTED, why="the server has lost it")
                self._turn_over(task.goal)

    def _server_answered(self, task: Task, stamp: int | None) -> None:
        """Take the server's answer to a goal."""
        if self._tasks.get(task.goal.id) is not task:
            if stamp is not None:
                self._cancel_at_server(task.goal.id)
        elif stamp is None:
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
        if self._tasks.get(goal.id) is not task:
            return
        if self.measured:
            self.measured.finished(goal.id, self._transport.now())
        if status == UNKNOWN:
            self._finish(task, ABORTED, why="the server has lost it")
        else:
            self._finish(task, status, result)
        self._turn_over(goal)

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
            self._turn_over(goal)
        for goal in self.goals:
            if not goal.client and states.get(goal.id, _OVER) == _OVER:
                self._end(goal, now)
                self._turn_over(goal)
        self._desk.tell()

    def _found(self, goal: Goal, now: int) -> None:
        """Let others wait for a goal that did not come through here."""
        self._current = goal
        self.pipeline.occupy(SERVER, now)
        self._bequest.keep()
        if self.braked:
            self.attend(now)

    def _turn_over(self, goal: Goal) -> None:
        """Let the next goal go if this was the one in progress."""
        if goal is self._current:
            self._current = None
            self._done(b"")

    # What the guard says

    def _finish(
        self, task: Task, status: int, result: object | None = None, *, why: str = ""
    ) -> None:
        """End a goal and answer its client; `why` says why the guard does, not the server."""
        goal, now = task.goal, self._transport.now()
        self._end(goal, now)
        self._bequest.keep_now()
        if why:
            log.info("%s: %s: %s", self.name, _said(goal), why)
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
        self.goals.end(goal, now)
        self._tasks.pop(goal.id, None)
        for gathering in self._gatherings.pop(goal.id, ()):
            gathering.told(goal.id, goal.stamp, ends=False)
        self._halt()
        self._bequest.keep()

    def _cancel_at_server(self, id: bytes) -> None:
        task = self._tasks.get(id)
        if task and not task.accepted:
            task.to_cancel = True
        elif self.server and not self.dry_run:
            self._ways.cancel(id, 0, partial(self._cancel_told, id))

    def _cancel_told(self, id: bytes, cancelled: Cancelled) -> None:
        goal = self.goals.find(id)
        ends = any(each == id for each, _ in cancelled.goals)
        if goal and goal.stopped and not ends:
            log.error("%s: the server does not cancel %s", self.name, _said(goal))
        for gathering in self._gatherings.pop(id, ()):
            gathering.told(id, goal.stamp if goal else 0, ends=ends)

    def _halt(self) -> None:
        """Keep the server from moving the robot while it has a goal that was stopped."""
        why = next((goal.stopped for goal in self.goals if goal.stopped), "")
        if why != self._halting:
            self._halting = why
            self.halted(self.server, why)

    def _complain(self, peer: Peer, why: str) -> None:
        if self._seldom.may_say("complaint", self._transport.now()):
            log.warning("%s: %s: %s", self.name, peer.node[:_LONGEST_NAME], why)


def _means(id: bytes, stamp: int, task: Task) -> bool:
    """Tell whether a cancel means a goal (action_msgs/CancelGoal)."""
    if id == NO_ID and not stamp:
        return True
    return task.goal.id == id or bool(stamp and task.goal.stamp <= stamp)


def _said(goal: Goal) -> str:
    return f"goal {goal.id.hex()} of {goal.client or 'the server itself'}"

"""A guarded action of ROS 2: to its clients the guard is the server, to the server the client.

As with an action of ROS 1 a goal goes through a pipeline, one that waits is told as accepted, and
each goal is answered once. A cancel touches only the goals of the client that sends it.
"""

import logging
import time
from collections.abc import Iterator
from functools import partial

from rtron.guard.action.common.stream import LONGEST_NAME, ORPHANED
from rtron.guard.action.ros2.cancel_requests import Gathering
from rtron.guard.action.ros2.endpoints import (
    REJECTED,
    TERMINATED,
    UNKNOWN_GOAL,
    AnswerCancel,
    AnswerGoal,
    AnswerResult,
    Cancelled,
    CarriesRequests,
    GoalMessage,
    ReadGoal,
)
from rtron.guard.action.ros2.places import Places
from rtron.guard.action.ros2.server_tracker import ServedRequests
from rtron.guard.action.ros2.task import Task
from rtron.guard.core.handover_state import Will
from rtron.guard.core.observations import Senses
from rtron.guard.transport.common.protocol import Peer, Transport
from rtron.messages.ros2.actions import ABORTED, CANCELED, NO_ID, UNKNOWN
from rtron.policies.goals.registry import Goal, Where
from rtron.vocabulary import SECOND, UNAPPROVED, Decision, Stream, Verdict, names_node

log = logging.getLogger(__name__)

_FOUND_WITHIN = 10 * SECOND
_CANCEL_PATIENCE = 5 * SECOND
_MOST_STRANGERS = 32


class RequestedAction(ServedRequests):
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
        super().__init__(stream, transport, senses, will, requests, dry_run=dry_run)
        self._places = Places(self.name, self._tasks, will, transport)

    def open(self) -> None:
        """Join the graph."""
        self._info = self._ways.info
        self._ways.open()
        self._is_open = True
        for why in self._braked_by.values():
            self._hold(why)
        self._take_over()
        self.attend(self._transport.now())

    def _take_over(self) -> None:
        """Go on with the goals of the guard before; those that waited went with it."""
        now = self._transport.now()
        for goal in self._inherited():
            if goal.client:
                self._tasks[goal.id] = Task(goal, accepted=goal.where is Where.SENT)
        self._places.take_over(self._ways.place)
        self._transport.call_at(now + ORPHANED, self._answer_orphans)
        self._transport.call_at(now + _FOUND_WITHIN, self._answer_unfound)

    def _answer_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended."""
        for task in list(self._tasks.values()):
            goal = task.goal
            if goal.client and goal.where is Where.WAITING and not goal.message:
                self._finish(task, ABORTED, why="the guard was restarted")

    # Whose a request is

    def _caller(self, flow: str, peer: Peer) -> tuple[str, str]:
        """Return the flow that a request counts for, and what its client is called here."""
        named = next((each for each in self.stream.flows if each.name == flow), None)
        if named and peer.verified and names_node(named.publisher, peer.node):
            return flow, peer.node
        place = f"on the private name of {flow}" if named else "under the public name"
        name = peer.node[:LONGEST_NAME]
        if self._may_say("stranger", name):
            log.warning("%s: unapproved client %s %s", self.name, name, place)
        if name in self.strangers or len(self.strangers) < _MOST_STRANGERS:
            self.strangers[name] = self.strangers.get(name, 0) + 1
        return UNAPPROVED, f"{UNAPPROVED} {peer.node}"

    def _shuts_out(self, flow: str) -> bool:
        return flow == UNAPPROVED and self.stream.block_unapproved and not self.dry_run

    # Goals

    def goal_asked(self, flow: str, peer: Peer, read: ReadGoal, answer: AnswerGoal) -> None:
        """Take a goal that was sent under the name of a flow; a stranger's is not even read."""
        flow, client = self._caller(flow, peer)
        if self._shuts_out(flow):
            self._receive(flow, b"")
            answer(None)
        else:
            self._take_goal(flow, client, peer, read(), answer)

    def _take_goal(
        self, flow: str, client: str, peer: Peer, message: GoalMessage, answer: AnswerGoal
    ) -> None:
        id, now = message.id, self._transport.now()
        if why := self._misfit() or self.goals.why_not(id, client, now):
            self._complain(peer, why)
            answer(None)
            return
        goal = Goal(id, time.time_ns(), flow, client, message, seen=now)
        self.goals.add(goal)
        task = self._tasks[id] = Task(goal, answer)
        self._decide(task)
        self._bequest.keep()

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

    def _passed(self, flow: str, message: bytes, now: int) -> None:
        goal = self.goals.find(message.id) if isinstance(message, GoalMessage) else None
        self._current = goal or self._current
        super()._passed(flow, message, now)
        if goal is None:
            self._transport.call_at(now, partial(self._done, b""))
        elif not self.dry_run:
            self._send(goal)
        for began in self.began if goal else ():
            began()

    def _say(self, flow: str, message: bytes) -> None:
        """Say nothing on topics: goals are sent one by one."""

    def _gave_up(self, message: bytes, verdict: Verdict) -> None:
        task = self._tasks.get(message.id) if isinstance(message, GoalMessage) else None
        if task and task.goal.where is Where.WAITING:
            status = CANCELED if task.cancelled else ABORTED
            self._finish(task, status, why=verdict.reason)

    # Results and cancels

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
        meant = list(self._meant(client, id, stamp))
        if not meant and id != NO_ID:
            over = self._results.find(id, client, now)
            answer(Cancelled(TERMINATED if over else UNKNOWN_GOAL))
            return
        gathering = Gathering(answer)
        for task in meant:
            self._cancel_one(task, gathering, now)
        gathering.complete()
        self._transport.call_at(now + _CANCEL_PATIENCE, gathering.give_up)

    def _meant(self, client: str, id: bytes, stamp: int) -> Iterator[Task]:
        """Yield the goals of a client that its cancel means (action_msgs/CancelGoal)."""
        for task in self._tasks.values():
            goal = task.goal
            all_of_them = id == NO_ID and not stamp
            meant = all_of_them or goal.id == id or (stamp and goal.stamp <= stamp)
            if meant and goal.client == client:
                yield task

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
            self._gatherings.await_(goal.id, gathering)
            self._cancel_at_server(goal.id)

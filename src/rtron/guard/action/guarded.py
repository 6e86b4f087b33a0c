"""A guarded action: its goals go through a pipeline, and its other topics move with them.

To the clients the guard is the server, to the server it is the client (design section 5). A goal
that waits here is told as pending; each goal is answered once, by the server or by the guard.
"""

import logging
from collections.abc import Callable
from functools import partial

from rtron.errors import InputError, WireError
from rtron.guard.action.bequest import Bequest
from rtron.guard.action.desk import Desk
from rtron.guard.action.ends import ActionEnds
from rtron.guard.action.room import roomy
from rtron.guard.action.server import Server
from rtron.guard.guarded import GuardedStream
from rtron.guard.seldom import Seldom
from rtron.guard.senses import Senses
from rtron.guard.transport.transport import Peer, Receive, Transport
from rtron.guard.will import Will
from rtron.messages.actionlib import (
    ABORTED,
    RECALLED,
    REJECTED,
    GoalID,
    cancel_message,
    read_cancel,
    read_goal,
    read_result,
    stamp_of,
    with_goal_id,
)
from rtron.policies.goals import MOST_GOALS, Goal, Goals, Where
from rtron.policies.listing import LOST_AFTER, TERMINAL, compare, find, lost
from rtron.vocabulary import (
    SECOND,
    SERVER,
    UNAPPROVED,
    ActionPart,
    Decision,
    Stream,
    Verdict,
    names_node,
    part_topic,
)

log = logging.getLogger(__name__)

_ORPHANED = 3 * SECOND


class GuardedAction(GuardedStream):
    """A guarded stream of goals, with the cancels, statuses, feedback and results beside it."""

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        senses: Senses,
        will: Will,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, senses, will, dry_run=dry_run)
        self.goals = Goals()
        self.server = Server()
        self.began: list[Callable[[], None]] = []
        self.freed: list[Callable[[], None]] = []
        self.appeared: list[Callable[[bytes], None]] = []
        self.ended: list[Callable[[bytes], None]] = []
        self.halted: Callable[[str, str], None] = lambda node, why: None
        self.pipeline.gave_up = self._gave_up
        self._parts = ActionEnds(self.stream, self.nodes[0], transport, self)
        self._current: Goal | None = None
        self._desk = Desk(self._parts, self.server, self.goals, transport, self._serves)
        self._bequest = Bequest(self.name, self.goals, will, transport)
        self._most_waiting = stream.queue_size
        self._named = 0
        self._absent = self._expecting = self._heard = False
        self._halting = ""
        self._seldom = Seldom()

    def open(self) -> None:
        """Join the graph."""
        super().open()
        self._parts.open()
        self._take_over()
        self.attend(self._transport.now())

    def attend(self, now: int) -> None:
        """Cancel what may not go on, and stop what it moves."""
        super().attend(now)
        for goal in () if self.dry_run else self.goals:
            if goal.where is Where.SENT and not goal.stopped:
                self._stop(goal, self._why_stopped(goal, now))
        self._halt()

    def _why_stopped(self, goal: Goal, now: int) -> str:
        """Return why a goal may not go on; one of the server's own unless all is stopped."""
        if goal.flow not in self.pipeline.tallies:
            return self.braked
        return self.pipeline.refusal(goal.flow, now, goal.message or None)

    def expect(self) -> None:
        """Let goals wait for one that the server is about to give itself."""
        self._expecting = True
        self.pipeline.occupy(SERVER, self._transport.now())

    def give_up(self, done: Callable[[], None]) -> None:
        """Expect no goal of the server's own any more, unless there is another after `done`."""
        self._expecting = False
        done()
        if not self._expecting and self._current is None and not self._absent:
            self._free()

    def stop(self, id: bytes, why: str) -> None:
        """Cancel a goal of the server's own, and stop what it moves."""
        goal = self.goals.find(id)
        if goal:
            self._stop(goal, why)
            self._halt()

    def _stop(self, goal: Goal, why: str) -> None:
        goal.stopped = why
        if why:
            log.warning("%s: %s is cancelled: %s", self.name, _said(goal), why)
            self._cancel_at_server(goal.id)

    def _cancel_at_server(self, id: bytes) -> None:
        if not self.dry_run:
            self._parts.cancel(cancel_message(id))

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
            "server": self.server.node if self._serves() else "not there",
        }

    def _complete(self, stream: Stream) -> Stream:
        """Let the queue have room for every flow's share, which is bounded before it."""
        return roomy(super()._complete(stream))

    def _keeps(self, peer: Peer) -> bool:  # noqa: ARG002
        """Keep no goal for late subscribers: what a server missed it must not do later."""
        return False

    def _open_done(self) -> None:
        """Know that a goal is done from its own result, whatever else the plan names."""
        if self.stream.done != part_topic(self.name, ActionPart.RESULT):
            super()._open_done()

    # What the guard before has left

    def _take_over(self) -> None:
        """Go on with the goals of the guard before; those that waited went with it."""
        now = self._transport.now()
        for goal in self.goals if self._bequest.take_over() else ():
            if goal.where is Where.SENT:
                self._current = goal
                self.pipeline.occupy(goal.flow, now)
        self._transport.call_at(now + _ORPHANED, self._answer_orphans)

    def _answer_orphans(self) -> None:
        """Answer the goals that waited with a guard that has ended, once their clients are back."""
        for goal in self.goals:
            if goal.where is Where.WAITING and not goal.message:
                self._answer(goal, RECALLED, "the guard was restarted")

    # What clients say

    def _taking(self, flow: str, peer: Peer) -> Receive:
        if flow == UNAPPROVED and self.stream.block_unapproved:
            return super()._taking(flow, peer)
        if self._is_server(peer):
            return self._reading(peer, self._own_goal)
        take = self._reading(peer, partial(self._goal, flow, peer))
        return self._latched.once(peer.node, take) if self._goes_once(peer) else take

    def _reading(self, peer: Peer, take: Callable[[bytes], None]) -> Receive:
        """Return what takes messages, and drops those that cannot be read."""

        def receive(message: bytes) -> None:
            try:
                take(message)
            except WireError as error:
                self._complain(peer, f"what it says cannot be read: {error}")

        return receive

    def _goal(self, flow: str, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        asked = read_goal(message)
        if not asked.id:
            asked = GoalID(self._name_goal(now), asked.stamp)
            message = with_goal_id(message, asked)
        if why := self.goals.why_not(asked.id, peer.node, now):
            self._complain(peer, why)
            return
        goal = Goal(asked.id, asked.stamp, flow, peer.node, message, seen=now)
        self.goals.add(goal)
        self._decide(goal, now)
        self._bequest.keep()

    def _decide(self, goal: Goal, now: int) -> None:
        if self.goals.came_cancelled(goal, now):
            self._answer(goal, RECALLED, "cancelled by its client")
        elif why := self._why_refused(goal):
            self._answer(goal, REJECTED, why)
        else:
            verdict = self._receive(goal.flow, goal.message)
            if verdict is None or verdict.decision is Decision.DROP:
                self._answer(goal, REJECTED, verdict.reason if verdict else "internal error")
            elif verdict.decision is Decision.HOLD:
                self._desk.tell_soon()

    def _why_refused(self, goal: Goal) -> str:
        """Return why a goal cannot be taken, whatever the policies say."""
        if self.dry_run:
            return ""
        if not self._hears():
            return "the action server is not there"
        if len(self.goals) > MOST_GOALS:
            return f"{MOST_GOALS} goals are not over"
        full = self.goals.waiting(goal.flow) > self._most_waiting
        return f"{self._most_waiting} goals wait" if full else ""

    def _passed(self, flow: str, message: bytes, now: int) -> None:
        asked = read_goal(message)
        super()._passed(flow, self._in_order(asked, message), now)
        goal = self.goals.find(asked.id)
        if goal:
            self.goals.send(goal, now)
            self._current = goal
            for began in self.began:
                began()
            self._bequest.keep()

    def _gave_up(self, message: bytes, verdict: Verdict) -> None:
        goal = self.goals.find(read_goal(message).id)
        if goal and goal.where is Where.WAITING:
            self._answer(goal, RECALLED, verdict.reason)

    def _in_order(self, asked: GoalID, message: bytes) -> bytes:
        stamp = self.goals.in_order(asked.stamp)
        return message if stamp == asked.stamp else with_goal_id(message, GoalID(asked.id, stamp))

    def cancels_of(self, flow: str, peer: Peer) -> Receive | None:
        """Return what takes the cancels of a client."""
        if flow == UNAPPROVED and self.stream.block_unapproved and not self.dry_run:
            return partial(self._complain, peer, "not approved, its cancels are dropped")
        return self._reading(peer, partial(self._cancel, peer))

    def _cancel(self, peer: Peer, message: bytes) -> None:
        now = self._transport.now()
        if self.dry_run:
            self._parts.cancel(message)
        asked = read_cancel(message)
        for goal in self.goals.cancelled(peer.node, asked.id, asked.stamp, now):
            if goal.where is Where.WAITING:
                self.pipeline.withdraw(goal.message, "cancelled by its client", now)
            else:
                self._cancel_at_server(goal.id)

    # What the server says

    def answers_of(self, part: ActionPart, peer: Peer) -> Receive | None:
        """Return what takes what the server says."""
        if part is ActionPart.RESULT:
            try:
                self.server.learn_result(peer.info)
            except InputError as error:
                self._complain(peer, str(error))
                return None
            return self._reading(peer, self._result)
        if part is ActionPart.STATUS:
            self.server.node = peer.node
            return self._reading(peer, self._status)
        return partial(self._parts.answer, part)

    def server_left(self, part: ActionPart, peer: Peer) -> None:
        """Learn that the server does not publish a part any more."""
        if part is ActionPart.STATUS and peer.node == self.server.node:
            log.warning("%s: the server %s is gone", self.name, peer.node)
            now = self._transport.now()
            self.server.leave()
            self._heard = False
            self._parts.forget()
            self._absent, self._current, self._expecting = True, None, False
            self.pipeline.occupy(SERVER, now)
            self._transport.call_at(now + LOST_AFTER, self._look_for_lost)

    def _status(self, message: bytes) -> None:
        now = self._transport.now()
        self.server.says(message, now)
        news = compare(self.goals, self.server.listed, now)
        for id in news.astray:
            self._cancel_at_server(id)
        for goal in news.found:
            self.goals.in_order(stamp_of(message, goal.id))
            self._found(goal, now)
        for goal in news.over:
            if not goal.client:
                self._end(goal, now)
            self._turn_over(goal)
        self._look_for_lost()
        self._repeat_cancels()
        self._welcome()
        self._desk.tell()

    def _repeat_cancels(self) -> None:
        """Say once more what a server could not hear that has been found only now."""
        heard, self._heard = self._heard, self._hears()
        for goal in self.goals if self._heard and not heard else ():
            if goal.stopped:
                self._cancel_at_server(goal.id)

    def _welcome(self) -> None:
        """Let goals go again that waited for a server which is back, if it has none of its own."""
        if self._absent and self._hears():
            self._absent = False
            if self._current is None:
                self._free()

    def _own_goal(self, message: bytes) -> None:
        """Take notice of a goal that the server gives itself, as move_base does."""
        now = self._transport.now()
        asked = read_goal(message)
        if asked.id and not self.goals.why_not(asked.id, "", now):
            self._found(find(self.goals, asked.id, now, asked.stamp), now)

    def _found(self, goal: Goal, now: int) -> None:
        """Let others wait for a goal that did not come through here."""
        self._current, self._expecting = goal, False
        self.pipeline.occupy(SERVER, now)
        self._bequest.keep()
        for appeared in self.appeared:
            appeared(goal.id)
        if self.braked:
            self.attend(now)

    def _result(self, message: bytes) -> None:
        now = self._transport.now()
        told = read_result(message)
        id = told.goal.id
        if self.measured:
            self.measured.finished(id, now)
        goal = self.goals.find(id)
        if goal is None and self.goals.is_over(id):
            return
        if goal is None:
            self.goals.remember(id, "", now)
        else:
            self._end(goal, now)
            self._desk.keep_listed(told)
        self._bequest.keep_now()
        self._parts.answer(ActionPart.RESULT, message)
        if goal:
            self._turn_over(goal)

    def _turn_over(self, goal: Goal) -> None:
        """Let the next goal go if this was the one in progress."""
        if goal is self._current:
            self._current = None
            self._free()

    def _free(self) -> None:
        """Let the next goal go: one that the server gives itself, if one waits, then our own."""
        for freed in self.freed:
            freed()
        if not self._expecting:
            self._done(b"")

    def _look_for_lost(self) -> None:
        """Answer the goals that the server has no more, and those whose result does not come."""
        told = self.server.at if self.server.node else self._transport.now()
        for goal in lost(self.goals, told):
            over = goal.status in TERMINAL
            self._answer(goal, goal.status if over else ABORTED, "the server has lost it")
            self._turn_over(goal)

    # What the guard says

    def _answer(self, goal: Goal, status: int, why: str) -> None:
        """End a goal in the server's place."""
        self._end(goal, self._transport.now())
        if goal.client and not self.dry_run:
            log.info("%s: %s: %s", self.name, _said(goal), why)
            self._desk.answer(goal, status, why)

    def _end(self, goal: Goal, now: int) -> None:
        self.goals.end(goal, now)
        self._halt()
        for ended in self.ended:
            ended(goal.id)
        self._bequest.keep()

    def _halt(self) -> None:
        """Keep the server from moving the robot while it has a goal that was stopped."""
        why = next((goal.stopped for goal in self.goals if goal.stopped), "")
        if why != self._halting:
            self._halting = why
            self.halted(self.server.node, why)

    def _hears(self) -> bool:
        """Tell whether the server is there, and hears us."""
        node = self.server.node
        return bool(node) and self._ends.reaches(node) and self._parts.reaches_server(node)

    def _serves(self) -> bool:
        """Tell whether clients may know that the server is there: they will get their answers."""
        return self._hears() and self.server.empty_result is not None

    def _is_server(self, peer: Peer) -> bool:
        return peer.verified and any(names_node(s, peer.node) for s in self.stream.successors)

    def _name_goal(self, now: int) -> bytes:
        self._named += 1
        return f"{self.nodes[0]}-{self._named}-{now // SECOND}.{now % SECOND:09}".encode()

    def _complain(self, peer: Peer, why: str, _message: bytes = b"") -> None:
        node = peer.node[:128]
        if self._seldom.may_say("complaint", self._transport.now()):
            log.warning("%s: %s: %s", self.name, node, why)


def _said(goal: Goal) -> str:
    return f"goal {goal.id.decode(errors='replace')[:128]!r} of {goal.client}"

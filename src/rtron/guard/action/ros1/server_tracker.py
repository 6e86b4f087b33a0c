"""An action of ROS 1 as its server sees it: what it says on its topics, and what it is told."""

import logging
from collections.abc import Callable
from functools import partial

from rtron.errors import InputError, WireError
from rtron.guard.action.common.stream import ActionStream
from rtron.guard.action.ros1.client_replies import Desk
from rtron.guard.action.ros1.server_state import Server
from rtron.guard.action.ros1.topics import ActionEnds, Hears
from rtron.guard.core.handover_state import Will
from rtron.guard.core.observations import Senses
from rtron.guard.transport.common.protocol import Peer, Receive, Transport
from rtron.messages.ros1.actions import ABORTED, cancel_message, read_goal, read_result, stamp_of
from rtron.policies.goals.registry import Goal
from rtron.policies.goals.status_list import LOST_AFTER, TERMINAL, compare, find, lost
from rtron.vocabulary import ActionPart, Stream, names_node

log = logging.getLogger(__name__)


class ServedAction(ActionStream, Hears):
    """Follows what becomes of goals at the server; each is answered once, by it or by the guard."""

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
        self.server = Server()
        self._parts = ActionEnds(self.stream, self.nodes[0], transport, self)
        self._desk = Desk(self._parts, self.server, self.goals, transport, self._serves)
        self._heard = False

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
            self._await_server(now)
            self._transport.call_at(now + LOST_AFTER, self._look_for_lost)

    def _reading(self, peer: Peer, take: Callable[[bytes], None]) -> Receive:
        """Return what takes messages, and drops those that cannot be read."""

        def receive(message: bytes) -> None:
            try:
                take(message)
            except WireError as error:
                self._complain(peer, f"what it says cannot be read: {error}")

        return receive

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

    def _own_goal(self, message: bytes) -> None:
        """Take notice of a goal that the server gives itself, as move_base does."""
        now = self._transport.now()
        asked = read_goal(message)
        if asked.id and not self.goals.why_not(asked.id, "", now):
            self._found(find(self.goals, asked.id, now, asked.stamp), now)

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

    def _look_for_lost(self) -> None:
        """Answer the goals that the server has no more, and those whose result does not come."""
        told = self.server.at if self.server.node else self._transport.now()
        for goal in lost(self.goals, told):
            over = goal.status in TERMINAL
            self._answer(goal, goal.status if over else ABORTED, "the server has lost it")
            self._turn_over(goal)

    def _answer(self, goal: Goal, status: int, why: str) -> None:
        """End a goal in the server's place."""
        self._end(goal, self._transport.now())
        if goal.client and not self.dry_run:
            log.info("%s: %s: %s", self.name, self._said(goal), why)
            self._desk.answer(goal, status, why)

    def _cancel_at_server(self, id: bytes) -> None:
        if not self.dry_run:
            self._parts.cancel(cancel_message(id))

    def _serving(self) -> str:
        return self.server.node

    def _hears(self) -> bool:
        node = self.server.node
        return bool(node) and self._ends.reaches(node) and self._parts.reaches_server(node)

    def _serves(self) -> bool:
        return self._hears() and self.server.empty_result is not None

    def _is_server(self, peer: Peer) -> bool:
        return peer.verified and any(names_node(s, peer.node) for s in self.stream.successors)

    def _said(self, goal: Goal) -> str:
        return f"goal {goal.id.decode(errors='replace')[:128]!r} of {goal.client}"

"""Goals without an id, as on `move_base_simple/goal`: followed to the goal that appears next."""

import logging
from collections.abc import Callable
from functools import partial
from typing import TypeVar

from rtron.errors import WireError
from rtron.guard.action.common.turns import SharingAction
from rtron.guard.core.handover_state import Will
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import Senses
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Output, Peer, Receive, Transport
from rtron.messages.ros1.actions import cancel_message, read_result, read_statuses
from rtron.policies.goals.goal_tracker import Following
from rtron.policies.goals.status_list import TERMINAL
from rtron.vocabulary import SECOND, SERVER, ActionPart, Stream, normalise_type, part_topic

log = logging.getLogger(__name__)

_APPEARS_WITHIN = 5 * SECOND

T = TypeVar("T")

_CANCEL, _STATUS = "actionlib_msgs/GoalID", "actionlib_msgs/GoalStatusArray"


def followed_action(stream: Stream) -> str:
    """Return the action whose result tells that a goal of the stream is done, or nothing."""
    if stream.action or not stream.done or not stream.done.endswith("/result"):
        return ""
    return stream.done.removesuffix("/result")


class FollowedStream(GuardedStream):
    """A guarded stream whose messages become goals of an action that has a guard or has none."""

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
        self._following = Following()
        self._guarded: SharingAction | None = None
        self._cancelled: bytes | None = None
        self._said = 0
        self._cancels: Output | None = None
        self._seldom = Seldom()

    @property
    def action(self) -> str:
        """The name of the action that the goals become."""
        return followed_action(self.stream)

    def follow(self, action: SharingAction) -> None:
        """Hear of goals from the guard of the action, which nobody else hears first."""
        self._guarded = action
        action.began.append(self._wait)
        action.appeared.append(self._appeared)
        action.ended.append(self._ended)
        action.freed.append(self._go_on)

    def attend(self, now: int) -> None:
        """Cancel the goal in progress if what asked for it may not go on."""
        super().attend(now)
        goal, flow = self._following.goal, self._following.flow
        if goal in (None, self._cancelled) or self.dry_run:
            return
        if why := self.pipeline.refusal(flow, now):
            self._cancelled = goal
            log.warning("%s: goal %r is cancelled: %s", self.stream.topic, goal[:128], why)
            self._cancel(goal, why)

    def _cancel(self, goal: bytes, why: str) -> None:
        if self._guarded:
            self._guarded.stop(goal, why)
        elif self._cancels:
            self._cancels.publish(cancel_message(goal))

    def _open_done(self) -> None:
        if not self._guarded:
            super()._open_done()
            self._open_action()

    def _open_action(self) -> None:
        """Hear of goals from an action that has no guard."""
        status = part_topic(self.action, ActionPart.STATUS)
        self._hear_successors(status, _STATUS, self._connect_status)
        topic = part_topic(self.action, ActionPart.CANCEL)
        info = standard_info(_CANCEL, self._transport.encoding)
        self._cancels = self._transport.advertise(self.nodes[0], topic, _CANCEL)
        if info:
            self._cancels.learn(info)

    def _connect_done(self, peer: Peer) -> Receive | None:
        take = super()._connect_done(peer)
        is_result = normalise_type(peer.info.type).endswith("ActionResult")
        return self._result if take and is_result else take

    def _connect_status(self, peer: Peer) -> Receive | None:
        return self._status if super()._connect_done(peer) else None

    def _passed(self, flow: str, message: bytes, now: int) -> None:
        super()._passed(flow, message, now)
        self._following.said(flow)
        self._said += 1
        if self._guarded:
            self._guarded.expect()
        self._transport.call_at(now + _APPEARS_WITHIN, partial(self._look_for, self._said))

    def _look_for(self, said: int) -> None:
        """Let others go if the server has made no goal of what was said."""
        if said == self._said and self._following.expecting:
            log.warning("%s: no goal has appeared", self.stream.topic)
            self._following.give_up()
            if self._guarded:
                self._guarded.give_up(partial(self._done, b""))
            else:
                self._done(b"")

    def _appeared(self, id: bytes) -> None:
        """Take a goal that the server has given itself; nobody here may have asked for it."""
        self._following.appears(id)
        if id != self._following.goal:
            self._wait()

    def _go_on(self) -> None:
        """Let goals go again that waited for one of the action."""
        if self.pipeline.owner == SERVER:
            self._done(b"")

    def _wait(self) -> None:
        """Let goals wait for one of the action."""
        self.pipeline.occupy(SERVER, self._transport.now())

    def _status(self, message: bytes) -> None:
        statuses = self._read(read_statuses, message) or {}
        self._following.sees(statuses)
        for id in [id for id, status in statuses.items() if status in TERMINAL]:
            self._ended(id)

    def _result(self, message: bytes) -> None:
        result = self._read(read_result, message)
        if result:
            self._ended(result.goal.id)

    def _read(self, read: Callable[[bytes], T], message: bytes) -> T | None:
        try:
            return read(message)
        except WireError as error:
            if self._seldom.may_say("unreadable", self._transport.now()):
                log.warning("%s: what the action says cannot be read: %s", self.stream.topic, error)
            return None

    def _ended(self, id: bytes) -> None:
        if self._following.over(id):
            self._done(b"")

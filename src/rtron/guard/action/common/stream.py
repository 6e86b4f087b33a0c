"""What the guard of an action does in either ROS: goals come and go, and are stopped if need be."""

import logging
from abc import abstractmethod
from collections.abc import Sequence

from rtron.guard.action.bequest import Bequest
from rtron.guard.action.common.turns import SharingAction
from rtron.guard.action.room import roomy
from rtron.guard.core.handover_state import Will
from rtron.guard.core.log_throttle import Seldom
from rtron.guard.core.observations import Senses
from rtron.guard.transport.common.protocol import Peer, Transport
from rtron.policies.goals.registry import MOST_GOALS, Goal, Where
from rtron.vocabulary import SECOND, SERVER, Stream, Verdict

log = logging.getLogger(__name__)

ORPHANED = 3 * SECOND
"""So long the clients of a guard that has ended may take to come to the next one."""
LONGEST_NAME = 128
_MOST_NAMES = 64


class ActionStream(SharingAction):
    """A guarded stream of goals; how they are spoken of is each ROS's own."""

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
        self.pipeline.gave_up = self._gave_up
        self._bequest = Bequest(self.name, self.goals, will, transport)
        self._most_waiting = stream.queue_size
        self._seldom = Seldom()

    def attend(self, now: int) -> None:
        """Cancel what may not go on, and stop what it moves."""
        super().attend(now)
        for goal in () if self.dry_run else self.goals:
            if goal.where is Where.SENT and not goal.stopped:
                self._stop(goal, self._why_stopped(goal, now))
        self._halt()

    @property
    def details(self) -> dict[str, str]:
        """What there is to tell beside the flows."""
        waiting = sum(goal.where is Where.WAITING for goal in self.goals)
        return {
            "goals": f"{waiting} waiting, {len(self.goals) - waiting} with the server",
            "server": self._serving() if self._serves() else "not there",
        }

    # What each ROS does its own way

    @abstractmethod
    def _hears(self) -> bool:
        """Tell whether the server is there, and hears us."""

    @abstractmethod
    def _serves(self) -> bool:
        """Tell whether clients may know that the server is there: they will get their answers."""

    @abstractmethod
    def _cancel_at_server(self, id: bytes) -> None:
        """Ask the server to cancel a goal."""

    @abstractmethod
    def _gave_up(self, message: bytes, verdict: Verdict) -> None:
        """Answer a goal that was held and will not go."""

    @abstractmethod
    def _said(self, goal: Goal) -> str:
        """Return what to call a goal."""

    # Goals that come and go

    def _complete(self, stream: Stream) -> Stream:
        """Let the queue have room for every flow's share, which is bounded before it."""
        return roomy(super()._complete(stream))

    def _inherited(self) -> Sequence[Goal]:
        """Go on with the goals of the guard before, and return them all."""
        inherited = list(self.goals) if self._bequest.take_over() else []
        for goal in inherited:
            if goal.where is Where.SENT:
                self._current = goal
                self.pipeline.occupy(goal.flow, self._transport.now())
        return inherited

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

    def _found(self, goal: Goal, now: int) -> None:
        """Let others wait for a goal that did not come through here."""
        self._current, self._expecting = goal, False
        self.pipeline.occupy(SERVER, now)
        self._bequest.keep()
        for appeared in self.appeared:
            appeared(goal.id)
        if self.braked:
            self.attend(now)

    def _end(self, goal: Goal, now: int) -> None:
        """Know that a goal is over."""
        self.goals.end(goal, now)
        self._halt()
        for ended in () if goal.client else self.ended:
            ended(goal.id)
        self._bequest.keep()

    # What may not go on

    def _why_stopped(self, goal: Goal, now: int) -> str:
        """Return why a goal may not go on; one of the server's own unless all is stopped."""
        if goal.flow not in self.pipeline.tallies:
            return self.braked
        return self.pipeline.refusal(goal.flow, now, goal.message or None)

    def _stop(self, goal: Goal, why: str) -> None:
        goal.stopped = why
        if why:
            log.warning("%s: %s is cancelled: %s", self.name, self._said(goal), why)
            self._cancel_at_server(goal.id)

    # A server that goes and comes back

    def _await_server(self, now: int) -> None:
        """Let goals wait for a server that is gone."""
        self._absent, self._current, self._expecting = True, None, False
        self.pipeline.occupy(SERVER, now)

    def _welcome(self) -> None:
        """Let goals go again that waited for a server which is back, if it has none of its own."""
        if self._absent and self._hears():
            self._absent = False
            if self._current is None:
                self._free()

    # What is told

    def _complain(self, peer: Peer, why: str) -> None:
        name = peer.node[:LONGEST_NAME]
        if self._may_say("complaint", name):
            log.warning("%s: %s: %s", self.name, name, why)

    def _may_say(self, what: str, name: str) -> bool:
        """Tell whether to say something of a node: one that makes much of it hides no other."""
        return self._seldom.may_say((what, hash(name) % _MOST_NAMES), self._transport.now())

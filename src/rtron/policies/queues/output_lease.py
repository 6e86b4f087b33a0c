"""Whose turn it is: what a queue asks before it lets a message go."""

from collections.abc import Mapping
from typing import Protocol

from rtron.policies.state_transfer import Carried, InTurn
from rtron.policies.verdicts import goes_next, has_output
from rtron.vocabulary import Flow, PolicySettings


class Turn(Protocol):
    """The right to the output: a flow takes it with a message that goes, and loses it by time."""

    @property
    def owner(self) -> Flow | None:
        """The flow whose turn it is."""
        ...

    def hear(self, flow: Flow, now: int) -> None:
        """Note that `flow` spoke at `now`, whether or not its message goes."""
        ...

    def why_wait(self, flow: Flow, first: Flow | None) -> str:
        """Return why a message of `flow` must wait, or nothing if it may go.

        `first` is the flow of the message that goes next, None if nothing else waits.
        """
        ...

    def take(self, flow: Flow, now: int) -> None:
        """Give the turn to `flow`, or renew it: one of its messages goes at `now`."""
        ...

    def lapse(self, now: int) -> None:
        """End what is over by `now`."""
        ...

    def end(self, now: int) -> None:
        """Let the owner's turn be over for the next `lapse`: what it had to do is done."""
        ...

    def ends(self) -> int | None:
        """Return when `lapse` next has something to do."""
        ...

    def in_turn(self) -> InTurn | None:
        """Return whose turn it is, and since when."""
        ...

    def spoke(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last."""
        ...

    def resume(self, owner: Flow | None, carried: Carried) -> None:
        """Go on where another turn has ended: with its owner, and with who spoke when."""
        ...


class SingleTurn:
    """One turn at a time, which nobody can interrupt.

    The turn of an action lasts until `end`, or until it is overdue: after its flow's `timeout`,
    and after `max_hold` in any case. A turn for commands (`renewable`) belongs to the flow: its
    further messages go and renew it, until the flow is silent for its `timeout` (`release_after`
    if it has none) or `max_hold` has passed since the turn began.
    """

    __slots__ = ("_began", "_default", "_ends", "_max_hold", "_owner", "_renewable", "_renewed")

    def __init__(self, settings: PolicySettings, *, renewable: bool) -> None:
        self._default = settings.release_after if renewable else settings.max_hold
        self._max_hold = settings.max_hold
        self._renewable = renewable
        self._owner: Flow | None = None
        self._began = self._renewed = self._ends = 0

    @property
    def owner(self) -> Flow | None:
        """The flow whose turn it is."""
        return self._owner

    def hear(self, flow: Flow, now: int) -> None:
        """Speaking without going changes nothing here."""

    def why_wait(self, flow: Flow, first: Flow | None) -> str:
        """Let a message go if nobody has the turn and nothing waits, or if it renews the turn."""
        if self._owner is None:
            return goes_next(first) if first else ""
        if self._renewable and flow is self._owner:
            return ""
        return has_output(self._owner)

    def take(self, flow: Flow, now: int) -> None:
        """Give the turn to `flow`, or renew it."""
        if flow is not self._owner:
            self._owner, self._began = flow, now
        timeout = self._default if flow.timeout is None else flow.timeout
        self._renewed = now
        self._ends = min(now + timeout, self._began + self._max_hold)

    def lapse(self, now: int) -> None:
        """End the turn if its flow fell silent or is overdue."""
        if self._owner is not None and now >= self._ends:
            self._owner = None

    def end(self, now: int) -> None:  # noqa: ARG002
        """End the turn."""
        self._owner = None

    def ends(self) -> int | None:
        """Return when the turn lapses."""
        return None if self._owner is None else self._ends

    def in_turn(self) -> InTurn | None:
        """Return whose turn it is, and since when."""
        owner = self._owner
        return InTurn(owner.name, self._began, self._renewed) if owner else None

    def spoke(self, now: int) -> Mapping[str, int]:  # noqa: ARG002
        """Return when the owner spoke last; nobody else has gone."""
        return {self._owner.name: self._renewed} if self._owner else {}

    def resume(self, owner: Flow | None, carried: Carried) -> None:
        """Go on with the owner's turn, which began when it did, as long as it may last here."""
        if owner and carried.turn:
            self.take(owner, carried.turn.began)
            self.take(owner, carried.turn.renewed)

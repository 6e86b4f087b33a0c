"""Whose turn it is: what a queue asks before it lets a message go."""

from collections.abc import Mapping
from typing import Protocol

from rtron.policies.state_transfer import LeaseState, PolicyState
from rtron.policies.verdicts import goes_next_reason, owns_output_reason
from rtron.vocabulary import Flow, PolicySettings


class OutputLease(Protocol):
    """The right to the output: a flow takes it with a message that goes, and loses it by time."""

    @property
    def owner(self) -> Flow | None:
        """The flow whose turn it is."""

    def record_message(self, flow: Flow, now: int) -> None:
        """Note that `flow` spoke at `now`, whether or not its message goes."""

    def wait_reason(self, flow: Flow, first: Flow | None) -> str:
        """Return why a message of `flow` must wait, or nothing if it may go.

        `first` is the flow of the message that goes next, None if nothing else waits.
        """

    def grant(self, flow: Flow, now: int) -> None:
        """Give the turn to `flow`, or renew it: one of its messages goes at `now`."""

    def expire(self, now: int) -> None:
        """End what is over by `now`."""

    def forget(self, flow: str, now: int) -> None:
        """Take `flow` for silent from `now` on."""

    def release(self, now: int) -> None:
        """Let the owner's turn be over for the next `expire`: what it had to do is done."""

    def expiry(self) -> int | None:
        """Return when `expire` next has something to do."""

    def state(self) -> LeaseState | None:
        """Return whose turn it is, and since when."""

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last."""

    def restore(self, owner: Flow | None, state: PolicyState) -> None:
        """Go on where another turn has ended: with its owner, and with who spoke when."""


class ExclusiveLease:
    """One turn at a time, which nobody can interrupt.

    The turn of an action lasts until `release`, or until it is overdue: after its flow's `timeout`,
    and after `max_hold` in any case. A turn for commands (`renewable`) belongs to the flow: its
    further messages go and renew it, until the flow is silent for its `timeout` (`release_after`
    if it has none) or `max_hold` has passed since the turn began.
    """

    __slots__ = (
        "_default",
        "_expires_at",
        "_granted_at",
        "_max_hold",
        "_owner",
        "_renewable",
        "_renewed_at",
    )

    def __init__(self, settings: PolicySettings, *, renewable: bool) -> None:
        self._default = settings.release_after if renewable else settings.max_hold
        self._max_hold = settings.max_hold
        self._renewable = renewable
        self._owner: Flow | None = None
        self._granted_at = self._renewed_at = self._expires_at = 0

    @property
    def owner(self) -> Flow | None:
        """The flow whose turn it is."""
        return self._owner

    def record_message(self, flow: Flow, now: int) -> None:
        """Speaking without going changes nothing here."""

    def wait_reason(self, flow: Flow, first: Flow | None) -> str:
        """Let a message go if nobody has the turn and nothing waits, or if it renews the turn."""
        if self._owner is None:
            return goes_next_reason(first) if first else ""
        if self._renewable and flow is self._owner:
            return ""
        return owns_output_reason(self._owner)

    def grant(self, flow: Flow, now: int) -> None:
        """Give the turn to `flow`, or renew it."""
        if flow is not self._owner:
            self._owner, self._granted_at = flow, now
        timeout = self._default if flow.timeout is None else flow.timeout
        self._renewed_at = now
        self._expires_at = min(now + timeout, self._granted_at + self._max_hold)

    def expire(self, now: int) -> None:
        """End the turn if its flow fell silent or is overdue."""
        if self._owner is not None and now >= self._expires_at:
            self._owner = None

    def forget(self, flow: str, now: int) -> None:
        """End the turn if it is the flow's."""
        if self._owner is not None and self._owner.name == flow:
            self._expires_at = now

    def release(self, now: int) -> None:  # noqa: ARG002
        """End the turn."""
        self._owner = None

    def expiry(self) -> int | None:
        """Return when the turn lapses."""
        return None if self._owner is None else self._expires_at

    def state(self) -> LeaseState | None:
        """Return whose turn it is, and since when."""
        owner = self._owner
        return LeaseState(owner.name, self._granted_at, self._renewed_at) if owner else None

    def last_message_times(self, now: int) -> Mapping[str, int]:  # noqa: ARG002
        """Return when the owner spoke last; nobody else has gone."""
        return {self._owner.name: self._renewed_at} if self._owner else {}

    def restore(self, owner: Flow | None, state: PolicyState) -> None:
        """Go on with the owner's turn, which began when it did, as long as it may last here."""
        if owner and state.lease:
            self.grant(owner, state.lease.granted_at)
            self.grant(owner, state.lease.renewed_at)

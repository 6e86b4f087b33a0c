"""What every policy is: a sans-I/O state machine with three verbs, and time passed in.

All times are integer nanoseconds of one steady clock and never go back. Only `tick` and `close`
let held messages leave, and each leaves exactly once. When `verdict` or `observe_done` makes
something due, `deadline` says so with a time that has come: tick after each call that leaves
`deadline() <= now`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from rtron.policies.state_transfer import PolicyState
from rtron.vocabulary import Verdict


@dataclass(frozen=True, slots=True)
class Release:
    """A message that leaves a policy by itself: one that was held, or one that goes out again.

    It is let go, or dropped with the reason. `restores`: it only gives back what a limit took.
    """

    message: object
    verdict: Verdict
    restores: bool = False


class Policy(Protocol):
    """One coordination node's rule for one topic.

    `message` is a handle that the policy keeps while it holds the message and never looks into;
    only those that limit a velocity are given a `Velocity`.
    A message of a flow that the settings do not name is dropped.
    """

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Decide about a message of `flow` that arrived at `now`."""

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return what `message` of `flow` is dropped with at `now`; nothing changes by asking.

        Without a message: what every message is dropped with, whatever it says.
        """

    def observe_done(self, now: int) -> None:
        """Learn that the action in progress is done."""

    def occupy(self, flow: str, now: int) -> None:
        """Learn that an action of `flow` is in progress that was not let go here."""

    def withdraw(self, message: object, why: str) -> None:
        """Give up a held message: the one that is this object; `tick` returns it."""

    def forget_flow(self, flow: str, now: int) -> None:
        """Learn that nobody speaks for `flow` any more: it is silent, and none of it is held."""

    def tick(self, now: int) -> Sequence[Release]:
        """Let time pass up to `now`; return what leaves the queue, in order."""

    def close(self) -> Sequence[Release]:
        """Give up every held message, because the end follows."""

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return when each flow spoke last (ns) that others still wait for at `now`."""

    def export_state(self, now: int) -> PolicyState:
        """Return what the policy that takes the place of this one must know; this one is done."""

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Go on, as the first thing of all, where the policy before has ended.

        Return the messages which waited there and cannot wait here, each with its verdict.
        """

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`, which are the same here."""

    def deadline(self) -> int | None:
        """Return when `tick` next has something to do, or None."""

    @property
    def owner(self) -> str | None:
        """The flow that has the output, or None while it is free."""


class ImmediatePolicy:
    """What a policy says that decides at once: it holds nothing, and time changes nothing."""

    __slots__ = ()

    def observe_done(self, now: int) -> None:
        """Nothing is in progress here."""

    def occupy(self, flow: str, now: int) -> None:
        """Nothing is in progress here."""

    def withdraw(self, message: object, why: str) -> None:
        """Nothing is ever held."""

    def forget_flow(self, flow: str, now: int) -> None:
        """Who has spoken does not matter here."""

    def tick(self, now: int) -> Sequence[Release]:  # noqa: ARG002
        """Nothing is ever held."""
        return ()

    def close(self) -> Sequence[Release]:
        """Nothing is ever held."""
        return ()

    def last_message_times(self, now: int) -> Mapping[str, int]:  # noqa: ARG002
        """Nobody waits for anybody."""
        return {}

    def export_state(self, now: int) -> PolicyState:  # noqa: ARG002
        """Nothing is remembered."""
        return PolicyState()

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:  # noqa: ARG002
        """Nothing of it matters here."""
        return ()

    def deadline(self) -> int | None:
        """Time changes nothing."""
        return None

    @property
    def owner(self) -> str | None:
        """Nobody: the flows share the output."""
        return None

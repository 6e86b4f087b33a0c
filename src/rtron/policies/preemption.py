"""Preemption: the fresh flow of highest priority owns the output.

## What it does

A flow is fresh from each of its messages until `release_after` of silence. The fresh flow of
highest priority owns the output: its messages pass at once, and those of lower flows are dropped. A
higher flow takes over with its first message. A blocked flow is never fresh.

## When to use it

For velocities: a safe control goes before a teleoperation, and this before the navigation. Dropped
commands are gone; if they should wait, use Priority_Queue.

## Settings

| setting | of | meaning |
|---|---|---|
| `priority` | each flow | the higher goes first; no two flows may have the same |
| `release_after` | the policy | the silence after which a flow gives up the output (0.5 s) |
| `block` | each flow | the flow's messages are dropped |

## States

The owner is reported as it was at the last message or tick.

## Example

>>> from rtron.policies import build_policy
>>> from rtron.vocabulary import SECOND, Flow, PolicyName, PolicySettings, StreamKind
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.PREEMPTION,
...     kind=StreamKind.COMMAND,
...     flows=(
...         Flow(name="flow1", publisher="/safe_control", priority=3),
...         Flow(name="flow2", publisher="/move_base", priority=1),
...     ),
...     release_after=SECOND // 2,
... ))
>>> policy.verdict("flow2", "forward", now=0).reason
'flow2 has the output (priority 1)'
>>> policy.verdict("flow1", "stop", now=SECOND // 10).reason
'flow1 has the output (priority 3)'
>>> verdict = policy.verdict("flow2", "forward", now=SECOND // 5)
>>> print(verdict.decision, "because", verdict.reason)
drop because flow1 has the output (priority 3)
>>> print(policy.verdict("flow2", "forward", now=SECOND).decision)
pass
"""

from collections.abc import Mapping, Sequence

from rtron.policies.active_flows import ActiveFlows, FlowActivity
from rtron.policies.policy import ImmediatePolicy, Release
from rtron.policies.state_machine import StateMachine, TableEnum, TransitionEffect, TransitionTable
from rtron.policies.state_transfer import PolicyState
from rtron.policies.verdicts import (
    FlowFilter,
    VerdictCache,
    check_priorities,
    owns_output_reason,
    with_priority,
)
from rtron.vocabulary import Decision, PolicySettings, Verdict


class PreemptionState(TableEnum):
    """The states of Preemption."""

    FREE = "no flow is fresh"
    OWNED = "the highest fresh flow owns the output"


class PreemptionInput(TableEnum):
    """What happens to Preemption."""

    HIGHEST = "a message, and no higher flow is fresh"
    LOWER = "a message while a higher flow is fresh"
    REFUSED = "a message of a blocked or unknown flow"
    FRESH = "a tick that finds a fresh flow"
    SILENT = "a tick that finds none"


TABLE: TransitionTable[PreemptionState, PreemptionInput] = {
    (PreemptionState.FREE, PreemptionInput.HIGHEST): (PreemptionState.OWNED, TransitionEffect.PASS),
    (PreemptionState.FREE, PreemptionInput.LOWER): (PreemptionState.FREE, TransitionEffect.NEVER),
    (PreemptionState.FREE, PreemptionInput.REFUSED): (PreemptionState.FREE, TransitionEffect.DROP),
    (PreemptionState.FREE, PreemptionInput.FRESH): (PreemptionState.FREE, TransitionEffect.NEVER),
    (PreemptionState.FREE, PreemptionInput.SILENT): (
        PreemptionState.FREE,
        TransitionEffect.NOTHING,
    ),
    (PreemptionState.OWNED, PreemptionInput.HIGHEST): (
        PreemptionState.OWNED,
        TransitionEffect.PASS,
    ),
    (PreemptionState.OWNED, PreemptionInput.LOWER): (PreemptionState.OWNED, TransitionEffect.DROP),
    (PreemptionState.OWNED, PreemptionInput.REFUSED): (
        PreemptionState.OWNED,
        TransitionEffect.DROP,
    ),
    (PreemptionState.OWNED, PreemptionInput.FRESH): (
        PreemptionState.OWNED,
        TransitionEffect.NOTHING,
    ),
    (PreemptionState.OWNED, PreemptionInput.SILENT): (
        PreemptionState.FREE,
        TransitionEffect.NOTHING,
    ),
}


_PASS, _LOWER, _HIGHEST = TransitionEffect.PASS, PreemptionInput.LOWER, PreemptionInput.HIGHEST


class Preemption(ImmediatePolicy):
    """The highest fresh flow passes, the others are dropped."""

    __slots__ = ("_active_flows", "_drop", "_filter", "_machine", "_owner", "_pass", "_reasons")

    def __init__(self, settings: PolicySettings) -> None:
        check_priorities(settings)
        self._filter = FlowFilter(settings)
        flows = self._filter.flows.values()
        self._active_flows = ActiveFlows(flows, lambda _: settings.release_after)
        self._reasons = {flow.name: with_priority(flow, owns_output_reason(flow)) for flow in flows}
        self._pass = VerdictCache(settings, Decision.PASS)
        self._drop = VerdictCache(settings, Decision.DROP)
        self._machine = StateMachine(TABLE, PreemptionState.FREE)
        self._owner: FlowActivity | None = None

    def verdict(self, flow: str, message: object, now: int) -> Verdict:  # noqa: ARG002
        """Pass the message if no higher flow is fresh at `now`, otherwise drop it."""
        activity = self._active_flows.by_name.get(flow)
        if activity is None:
            self._machine.step(PreemptionInput.REFUSED)
            return self._filter.refusal(flow)
        self._active_flows.record_message(activity, now)
        self._owner = owner = self._active_flows.highest_priority(now) or activity
        verdicts = self._pass if self._step(activity, owner) is _PASS else self._drop
        return verdicts.get(flow, self._reasons[owner.flow.name])

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return the refusal of a flow that is blocked or unknown."""
        return None if flow in self._filter.flows else self._filter.refusal(flow)

    def forget_flow(self, flow: str, now: int) -> None:
        """Let the lower flows have the output at once."""
        self._active_flows.forget(flow, now)
        self.tick(now)

    def tick(self, now: int) -> Sequence[Release]:
        """Find the owner at `now`; nothing is ever held."""
        self._owner = self._active_flows.highest_priority(now)
        self._machine.step(PreemptionInput.SILENT if self._owner is None else PreemptionInput.FRESH)
        return ()

    def deadline(self) -> int | None:
        """Return when the owner falls silent if it says nothing more."""
        return self._owner.expires_at if self._owner else None

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last."""
        return self._active_flows.last_message_times(now)

    def export_state(self, now: int) -> PolicyState:
        """Return who is fresh."""
        return PolicyState(last_message_times=self.last_message_times(now))

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Know who is fresh, and who of them owns the output; let go what waited."""
        self._active_flows.restore(state.last_message_times)
        self._owner = self._active_flows.highest_priority(now)
        if self._owner:
            self._machine.step(PreemptionInput.HIGHEST)
        return self._filter.release_held(state.held_messages)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._filter, self._pass, self._drop):
            each.revise(revision)

    @property
    def owner(self) -> str | None:
        """The highest fresh flow, as of the last message or tick."""
        return self._owner.flow.name if self._owner else None

    def _step(self, activity: FlowActivity, owner: FlowActivity) -> TransitionEffect:
        lower = owner.flow.priority > activity.flow.priority
        return self._machine.step(_LOWER if lower else _HIGHEST)

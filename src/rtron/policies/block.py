"""Block: drops the messages of blocked flows and passes all others.

## What it does

A flow whose block bit is set is dropped, and so is a publisher that the plan does not name. All
other messages pass at once, in any order.

## When to use it

- In a GRCN: to stop what a node does, in an emergency.
- In an RSRCN: to keep a node from setting the maximal velocity.
- In an MSRCN: to forbid an action under the conditions of a rule.

## Settings

| setting | of | meaning |
|---|---|---|
| `block` | each flow | the flow's messages are dropped |

## States

Block has one state.

## Example

>>> from rtron.policies import build_policy
>>> from rtron.vocabulary import Flow, PolicyName, PolicySettings, StreamKind
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.BLOCK,
...     kind=StreamKind.COMMAND,
...     flows=(
...         Flow(name="flow1", publisher="/move_base"),
...         Flow(name="flow2", publisher="/teleop", block=True),
...     ),
... ))
>>> policy.verdict("flow1", "forward", now=0).reason
'flow1 is not blocked'
>>> policy.verdict("flow2", "left", now=0).reason
'flow2 is blocked'
"""

from collections.abc import Sequence

from rtron.policies.policy import ImmediatePolicy, Release
from rtron.policies.state_machine import StateMachine, TableEnum, TransitionEffect, TransitionTable
from rtron.policies.state_transfer import PolicyState
from rtron.policies.verdicts import FlowFilter, VerdictCache
from rtron.vocabulary import Decision, PolicySettings, Verdict


class BlockState(TableEnum):
    """The state of Block."""

    WATCHING = "bits are looked up"


class BlockInput(TableEnum):
    """What happens to Block."""

    ALLOWED = "a message of a flow whose block bit is 0"
    REFUSED = "a message of a blocked or unknown flow"


TABLE: TransitionTable[BlockState, BlockInput] = {
    (BlockState.WATCHING, BlockInput.ALLOWED): (BlockState.WATCHING, TransitionEffect.PASS),
    (BlockState.WATCHING, BlockInput.REFUSED): (BlockState.WATCHING, TransitionEffect.DROP),
}


class Block(ImmediatePolicy):
    """A block bit for each flow."""

    __slots__ = ("_filter", "_last_message_times", "_machine", "_pass", "_reasons")

    def __init__(self, settings: PolicySettings) -> None:
        self._filter = FlowFilter(settings)
        self._machine = StateMachine(TABLE, BlockState.WATCHING)
        self._pass = VerdictCache(settings, Decision.PASS)
        self._reasons = {name: f"{name} is not blocked" for name in self._filter.flows}
        self._last_message_times: dict[str, int] = {}

    def verdict(self, flow: str, message: object, now: int) -> Verdict:  # noqa: ARG002
        """Pass the message unless its flow is blocked or unknown."""
        reason = self._reasons.get(flow)
        if reason is None:
            self._machine.step(BlockInput.REFUSED)
            return self._filter.refusal(flow)
        self._machine.step(BlockInput.ALLOWED)
        self._last_message_times[flow] = now
        return self._pass.get(flow, reason)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return the refusal of a flow that is blocked or unknown."""
        return None if flow in self._filter.flows else self._filter.refusal(flow)

    def export_state(self, now: int) -> PolicyState:  # noqa: ARG002
        """Return when each flow spoke last."""
        return PolicyState(last_message_times=self._last_message_times)

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:  # noqa: ARG002
        """Know who spoke when; let go what waited."""
        self._last_message_times = {
            flow: at for flow, at in state.last_message_times.items() if flow in self._filter.flows
        }
        return self._filter.release_held(state.held_messages)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        self._filter.revise(revision)
        self._pass.revise(revision)

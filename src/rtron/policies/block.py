"""Block: drops the messages of blocked flows and passes all others.

## What it does

Every flow has a block bit. While it is set, the flow's messages are dropped; the messages of all
other flows of the plan pass at once, in any order. A publisher that the plan does not name is
dropped too.

## When to use it

- In a GRCN: to stop what a node does, at once, in an emergency.
- In an RSRCN: to keep a node from setting the maximal velocity.
- In an MSRCN: to forbid an action under the conditions of a rule.

## Settings

| setting | of | meaning |
|---|---|---|
| `block` | each flow | the flow's messages are dropped |

## States

Block has one state. It remembers when each flow spoke last, for a policy that takes its place.

## Example

>>> from rtron.policies import build
>>> from rtron.vocabulary import Flow, PolicyName, PolicySettings, StreamKind
>>> policy = build(PolicySettings(
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

from rtron.policies.policy import Immediate, Release
from rtron.policies.state_machine import Effect, Machine, Named, Table
from rtron.policies.state_transfer import Carried
from rtron.policies.verdicts import Answers, Gate
from rtron.vocabulary import Decision, PolicySettings, Verdict


class State(Named):
    """The state of Block."""

    WATCHING = "bits are looked up"


class Input(Named):
    """What happens to Block."""

    ALLOWED = "a message of a flow whose block bit is 0"
    REFUSED = "a message of a blocked or unknown flow"


TABLE: Table[State, Input] = {
    (State.WATCHING, Input.ALLOWED): (State.WATCHING, Effect.PASS),
    (State.WATCHING, Input.REFUSED): (State.WATCHING, Effect.DROP),
}


class Block(Immediate):
    """A block bit for each flow."""

    __slots__ = ("_gate", "_machine", "_pass", "_reasons", "_spoke")

    def __init__(self, settings: PolicySettings) -> None:
        self._gate = Gate(settings)
        self._machine = Machine(TABLE, State.WATCHING)
        self._pass = Answers(settings, Decision.PASS)
        self._reasons = {name: f"{name} is not blocked" for name in self._gate.flows}
        self._spoke: dict[str, int] = {}

    def verdict(self, flow: str, message: object, now: int) -> Verdict:  # noqa: ARG002
        """Pass the message unless its flow is blocked or unknown."""
        reason = self._reasons.get(flow)
        if reason is None:
            self._machine.step(Input.REFUSED)
            return self._gate.refusal(flow)
        self._machine.step(Input.ALLOWED)
        self._spoke[flow] = now
        return self._pass.give(flow, reason)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return the refusal of a flow that is blocked or unknown."""
        return None if flow in self._gate.flows else self._gate.refusal(flow)

    def carry(self, now: int) -> Carried:  # noqa: ARG002
        """Return when each flow spoke last."""
        return Carried(spoke=self._spoke)

    def resume(self, carried: Carried, now: int) -> Sequence[Release]:  # noqa: ARG002
        """Know who spoke when; let go what waited."""
        self._spoke = {flow: at for flow, at in carried.spoke.items() if flow in self._gate.flows}
        return self._gate.give_up(carried.held)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        self._gate.revise(revision)
        self._pass.revise(revision)

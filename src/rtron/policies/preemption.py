"""Preemption: the fresh flow of highest priority owns the output.

## What it does

A flow is fresh from each of its messages until `release_after` of silence. The fresh flow of
highest priority owns the output: its messages pass at once, those of lower flows are dropped, and
a higher flow that starts to speak takes over with its first message. When the owner falls silent,
the next fresh flow owns the output. A flow that has never spoken owns nothing and stands in
nobody's way; so does a blocked one, however much it speaks.

## When to use it

For instant control, such as the topic of a velocity: a safe control goes before a teleoperation,
and this before the navigation. Dropped commands are gone; if they should wait, use
Priority_Queue.

## Settings

| setting | of | meaning |
|---|---|---|
| `priority` | each flow | the higher goes first; no two flows may have the same |
| `release_after` | the policy | the silence after which a flow gives up the output (0.5 s) |
| `block` | each flow | the flow's messages are dropped |

## States

The owner is reported as it was at the last message or tick. The deadline is the moment at which
the owner falls silent, so that a tick then finds the output idle, or the next owner.

## Example

>>> from rtron.policies import build
>>> from rtron.vocabulary import SECOND, Flow, PolicyName, PolicySettings, StreamKind
>>> policy = build(PolicySettings(
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

from collections.abc import Sequence

from rtron.policies.active_flows import Speaker, Speakers
from rtron.policies.policy import Immediate, Release
from rtron.policies.state_machine import Effect, Machine, Named, Table
from rtron.policies.state_transfer import Carried
from rtron.policies.verdicts import Answers, Gate, check_priorities, has_output, with_priority
from rtron.vocabulary import Decision, PolicySettings, Verdict


class State(Named):
    """The states of Preemption."""

    FREE = "no flow is fresh"
    OWNED = "the highest fresh flow owns the output"


class Input(Named):
    """What happens to Preemption."""

    HIGHEST = "a message, and no higher flow is fresh"
    LOWER = "a message while a higher flow is fresh"
    REFUSED = "a message of a blocked or unknown flow"
    FRESH = "a tick that finds a fresh flow"
    SILENT = "a tick that finds none"


TABLE: Table[State, Input] = {
    (State.FREE, Input.HIGHEST): (State.OWNED, Effect.PASS),
    (State.FREE, Input.LOWER): (State.FREE, Effect.NEVER),
    (State.FREE, Input.REFUSED): (State.FREE, Effect.DROP),
    (State.FREE, Input.FRESH): (State.FREE, Effect.NEVER),
    (State.FREE, Input.SILENT): (State.FREE, Effect.NOTHING),
    (State.OWNED, Input.HIGHEST): (State.OWNED, Effect.PASS),
    (State.OWNED, Input.LOWER): (State.OWNED, Effect.DROP),
    (State.OWNED, Input.REFUSED): (State.OWNED, Effect.DROP),
    (State.OWNED, Input.FRESH): (State.OWNED, Effect.NOTHING),
    (State.OWNED, Input.SILENT): (State.FREE, Effect.NOTHING),
}


class Preemption(Immediate):
    """The highest fresh flow passes, the others are dropped."""

    __slots__ = ("_drop", "_gate", "_machine", "_owner", "_pass", "_reasons", "_speakers")

    def __init__(self, settings: PolicySettings) -> None:
        check_priorities(settings)
        self._gate = Gate(settings)
        flows = self._gate.flows.values()
        self._speakers = Speakers(flows, lambda _: settings.release_after)
        self._reasons = {flow.name: with_priority(flow, has_output(flow)) for flow in flows}
        self._pass = Answers(settings, Decision.PASS)
        self._drop = Answers(settings, Decision.DROP)
        self._machine = Machine(TABLE, State.FREE)
        self._owner: Speaker | None = None

    def verdict(self, flow: str, message: object, now: int) -> Verdict:  # noqa: ARG002
        """Pass the message if no higher flow is fresh at `now`, otherwise drop it."""
        speaker = self._speakers.named.get(flow)
        if speaker is None:
            self._machine.step(Input.REFUSED)
            return self._gate.refusal(flow)
        self._speakers.hear(speaker, now)
        self._owner = owner = self._speakers.highest(now) or speaker
        answers = self._pass if self._step(speaker, owner) is Effect.PASS else self._drop
        return answers.give(flow, self._reasons[owner.flow.name])

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return the refusal of a flow that is blocked or unknown."""
        return None if flow in self._gate.flows else self._gate.refusal(flow)

    def tick(self, now: int) -> Sequence[Release]:
        """Find the owner at `now`; nothing is ever held."""
        self._owner = self._speakers.highest(now)
        self._machine.step(Input.SILENT if self._owner is None else Input.FRESH)
        return ()

    def deadline(self) -> int | None:
        """Return when the owner falls silent if it says nothing more."""
        return self._owner.lapses if self._owner else None

    def carry(self, now: int) -> Carried:
        """Return who is fresh."""
        return Carried(spoke=self._speakers.spoke(now))

    def resume(self, carried: Carried, now: int) -> Sequence[Release]:
        """Know who is fresh, and who of them owns the output; let go what waited."""
        self._speakers.resume(carried.spoke)
        self._owner = self._speakers.highest(now)
        if self._owner:
            self._machine.step(Input.HIGHEST)
        return self._gate.give_up(carried.held)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._gate, self._pass, self._drop):
            each.revise(revision)

    @property
    def owner(self) -> str | None:
        """The highest fresh flow, as of the last message or tick."""
        return self._owner.flow.name if self._owner else None

    def _step(self, speaker: Speaker, owner: Speaker) -> Effect:
        lower = owner.flow.priority > speaker.flow.priority
        return self._machine.step(Input.LOWER if lower else Input.HIGHEST)

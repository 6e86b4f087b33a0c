"""What Safe and Constrain have in common: a velocity is at most the limit, whoever asks for it.

A message here is a `Velocity`, or a text that says why it is none. One above the limit goes on
changed: it is scaled as a whole, so that the curvature stays. NaN and Inf are dropped. On the topic
of a maximal velocity (`reissues`), where nobody need speak again, what was asked for last goes out
once more when the limit changes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from rtron.policies.active_flows import Speakers
from rtron.policies.policy import Immediate, Release
from rtron.policies.state_machine import Effect, Machine, Named, Table
from rtron.policies.state_transfer import Asked, Carried
from rtron.policies.verdicts import Answers, Gate, check_priorities, has_output, with_priority
from rtron.vocabulary import SECOND, UNAPPROVED, Decision, PolicySettings, Velocity, Verdict

REISSUE_PERIOD = SECOND // 10


@dataclass(frozen=True, slots=True)
class Limit:
    """A speed (m/s) that is not to be exceeded, and why."""

    speed: float
    why: str


class Limits(Protocol):
    """Tells the limit of the moment."""

    def at(self, now: int) -> Limit:
        """Return the limit at `now`."""
        ...

    @property
    def varies(self) -> bool:
        """Whether the limit ever changes."""
        ...


class State(Named):
    """The states of a limit."""

    WITHIN = "what was asked for last is within the limit"
    LIMITED = "what was asked for last is above the limit"


class Input(Named):
    """What happens to a limit."""

    BELOW = "a velocity within the limit"
    ABOVE = "a velocity above the limit"
    INVALID = "NaN, Inf, or what is no velocity at all"
    REST = "a velocity while nothing may move"
    LOWER = "a message while a flow of higher priority is fresh"
    REFUSED = "a message of a blocked or unknown flow"
    CHANGED = "the limit changes what goes on"
    FREED = "the limit is no longer below what was asked for"


TABLE: Table[State, Input] = {
    (State.WITHIN, Input.BELOW): (State.WITHIN, Effect.PASS),
    (State.WITHIN, Input.ABOVE): (State.LIMITED, Effect.MODIFY),
    (State.WITHIN, Input.INVALID): (State.WITHIN, Effect.DROP),
    (State.WITHIN, Input.REST): (State.WITHIN, Effect.DROP),
    (State.WITHIN, Input.LOWER): (State.WITHIN, Effect.DROP),
    (State.WITHIN, Input.REFUSED): (State.WITHIN, Effect.DROP),
    (State.WITHIN, Input.CHANGED): (State.LIMITED, Effect.REISSUE),
    (State.WITHIN, Input.FREED): (State.WITHIN, Effect.NEVER),
    (State.LIMITED, Input.BELOW): (State.WITHIN, Effect.PASS),
    (State.LIMITED, Input.ABOVE): (State.LIMITED, Effect.MODIFY),
    (State.LIMITED, Input.INVALID): (State.LIMITED, Effect.DROP),
    (State.LIMITED, Input.REST): (State.LIMITED, Effect.DROP),
    (State.LIMITED, Input.LOWER): (State.LIMITED, Effect.DROP),
    (State.LIMITED, Input.REFUSED): (State.LIMITED, Effect.DROP),
    (State.LIMITED, Input.CHANGED): (State.LIMITED, Effect.REISSUE),
    (State.LIMITED, Input.FREED): (State.WITHIN, Effect.REISSUE),
}


@dataclass(slots=True)
class _Asked:
    """The velocity that was asked for last, and what of it goes on."""

    flow: str
    wanted: Velocity
    sent: Velocity


class Limiting(Immediate):
    """Changes velocities above the limit; drops what cannot be judged."""

    def __init__(self, settings: PolicySettings, limits: Limits) -> None:
        self._gate = Gate(settings)
        self._limits = limits
        self._pass = Answers(settings, Decision.PASS)
        self._drop = Answers(settings, Decision.DROP)
        self._modify = Answers(settings, Decision.MODIFY)
        self._machine = Machine(TABLE, State.WITHIN)
        self._speakers = self._ordered(settings)
        self._spoke: dict[str, int] = {}
        self._asked: _Asked | None = None
        self._due: int | None = None
        self._now = 0
        self.reissues = False

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Pass the velocity if it is within the limit at `now`, otherwise change it."""
        self._now = now
        if flow not in self._gate.flows:
            self._machine.step(Input.REFUSED)
            return self._gate.refusal(flow)
        if not isinstance(message, Velocity) or not message.finite:
            self._machine.step(Input.INVALID)
            why = message if isinstance(message, str) else "NaN or Inf is no velocity"
            return self._drop.once(flow, why, error=True)
        if higher := self._higher(flow, now):
            self._machine.step(Input.LOWER)
            return self._drop.give(flow, higher)
        return self._judge(flow, message, now)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return what any velocity of `flow` is refused with now: blocked, or the limit is 0."""
        if flow not in self._gate.flows:
            return self._gate.refusal(flow)
        limit = self._limits.at(now)
        return self._drop.give(flow, _nothing(limit)) if self._rests(limit) else None

    def limit(self, now: int) -> float:
        """Return the speed (m/s) that is not to be exceeded at `now`."""
        return self._limits.at(now).speed

    def tick(self, now: int) -> Sequence[Release]:
        """Let what was asked for last go out again if the limit has changed."""
        self._now = now
        asked, due = self._asked, self.deadline()
        if asked is None or due is None or now < due:
            return ()
        self._look_later(now)
        if not self.reissues:
            return ()
        limit = self._limits.at(now)
        velocity = asked.wanted.at_most(limit.speed)
        if velocity == asked.sent:
            return ()
        self._machine.step(Input.FREED if velocity is asked.wanted else Input.CHANGED)
        restores, asked.sent = velocity.speed > asked.sent.speed, velocity
        return (Release(velocity, self._changed(asked, limit), restores),)

    def again(self, now: int) -> None:
        """Look at what was asked for last again, all of which has gone on meanwhile."""
        if self._asked:
            self._asked.sent = self._asked.wanted
            self._due = now

    def carry(self, now: int) -> Carried:
        """Return what was asked for last, and who is fresh."""
        asked = self._asked
        return Carried(
            spoke=self._speakers.spoke(now) if self._speakers else self._spoke,
            asked=Asked(asked.flow, asked.wanted, asked.sent) if asked else None,
        )

    def resume(self, carried: Carried, now: int) -> Sequence[Release]:
        """Know who is fresh, and look at once whether the limit changes what was asked for last.

        A flow that is blocked by now gets nothing back.
        """
        self._spoke = {flow: at for flow, at in carried.spoke.items() if flow in self._gate.flows}
        if self._speakers:
            self._speakers.resume(self._spoke)
        if carried.asked:
            self._take_over(carried.asked)
            self._due = now
        return ()

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._gate, self._pass, self._drop, self._modify):
            each.revise(revision)

    def deadline(self) -> int | None:
        """Return when to look at a changing limit again."""
        return self._due

    @property
    def owner(self) -> str | None:
        """The flow of highest priority, where the flows have an order."""
        speaker = self._speakers.highest(self._now) if self._speakers else None
        return speaker.flow.name if speaker else None

    def _take_over(self, asked: Asked) -> None:
        wanted = asked.wanted if asked.flow in self._gate.flows else asked.sent
        self._asked = _Asked(asked.flow, wanted, asked.sent)
        if asked.sent != wanted:
            self._machine.step(Input.ABOVE)

    def _judge(self, flow: str, wanted: Velocity, now: int) -> Verdict:
        limit = self._limits.at(now)
        if self._rests(limit):
            self._machine.step(Input.REST)
            return self._drop.give(flow, _nothing(limit))
        velocity = wanted.at_most(limit.speed)
        self._asked = asked = _Asked(flow, wanted, velocity)
        self._look_later(now)
        if velocity is wanted:
            self._machine.step(Input.BELOW)
            return self._pass.give(flow, f"within {limit.why}")
        self._machine.step(Input.ABOVE)
        return self._changed(asked, limit)

    def _look_later(self, now: int) -> None:
        self._due = now + REISSUE_PERIOD if self._limits.varies else None

    def _rests(self, limit: Limit) -> bool:
        """Tell whether nothing passes: a limit of 0, but for who asks what the limit is."""
        return limit.speed == 0 and not self.reissues

    def _changed(self, asked: _Asked, limit: Limit) -> Verdict:
        told = "within" if asked.sent is asked.wanted else "limited to"
        return self._modify.once(asked.flow, f"{told} {limit.why}", asked.sent)

    def _higher(self, flow: str, now: int) -> str:
        """Return why a message of `flow` must not go: a flow of higher priority has spoken."""
        if self._speakers is None:
            self._spoke[flow] = now
            return ""
        speaker = self._speakers.named[flow]
        self._speakers.hear(speaker, now)
        highest = self._speakers.highest(now) or speaker
        return "" if highest is speaker else with_priority(highest.flow, has_output(highest.flow))

    def _ordered(self, settings: PolicySettings) -> Speakers | None:
        """Return the flows in their order; None where all have the same priority, so no order."""
        approved = (flow for flow in settings.flows if flow.name != UNAPPROVED)
        if len({flow.priority for flow in approved}) <= 1:
            return None
        check_priorities(settings)
        return Speakers(self._gate.flows.values(), lambda _: settings.release_after)


def _nothing(limit: Limit) -> str:
    return f"nothing moves: {limit.why}"

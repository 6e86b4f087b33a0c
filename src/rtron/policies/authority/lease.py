"""Lease: the commander that holds the lease of a group of streams is the only one that passes.

## What it does

Only the holder of a group's lease moves what the streams of the group move, such as the base. A
commander gets the lease on request, and keeps it until it gives it back, until another one takes
over by consent or by rank, or until nobody renews it. Without a holder, nobody moves anything. When
the holder loses the lease, the robot stops. A new holder, or one whose publisher was gone, must
first send a neutral command on each stream, one that moves nothing.

## When to use it

Where people, web pages, scripts and agents command one robot. For the app's own nodes Preemption
needs no requests. It is for velocities only. [Leases](../leases.md).

## Settings

| setting | of | meaning |
|---|---|---|
| `lease` | the policy | the group of streams that share one lease |
| `ttl` | the lease | how long it holds after it was granted or renewed last (5 s) |
| `service` | the lease | the rank of people at the security service; none: they only look |
| `rank` | each flow | emergency, operator_on_site, remote_operator, autonomy or agent, the lowest |
| `block` | each flow | the flow's messages are dropped |

## States

A commander is known by the publisher of its flow.

## Example

>>> from rtron.policies import build_policy
>>> from rtron.policies.authority.command_lease import CommandLease, Commander
>>> from rtron.vocabulary import SECOND, CommanderRank, Flow, PolicyName, PolicySettings, StreamKind
>>> base = CommandLease("base", (
...     Commander("/teleop", CommanderRank.OPERATOR_ON_SITE),
...     Commander("/move_base", CommanderRank.AUTONOMY),
... ), ttl=5 * SECOND)
>>> policy = build_policy(PolicySettings(
...     policy=PolicyName.LEASE,
...     kind=StreamKind.COMMAND,
...     flows=(
...         Flow(name="flow1", publisher="/teleop"),
...         Flow(name="flow2", publisher="/move_base"),
...     ),
...     lease="base",
... ), leases={"base": base})
>>> policy.is_neutral = lambda message: message == "stand"
>>> policy.verdict("flow1", "forward", now=0).reason
'nobody holds base'
>>> base.acquire("/move_base", now=0).granted
True
>>> policy.verdict("flow2", "forward", now=0).reason
'/move_base (autonomy) must send a neutral command first'
>>> policy.verdict("flow2", "stand", now=0).reason
'/move_base (autonomy) holds base'
>>> print(policy.verdict("flow2", "forward", now=0).decision)
pass
>>> base.take_over("/teleop", now=SECOND, why="a person is in the way").granted
True
>>> policy.verdict("flow2", "forward", now=SECOND).reason
'/teleop (operator_on_site) holds base'
"""

from collections.abc import Callable, Sequence

from rtron.policies.authority.command_lease import CommandLease, Grant
from rtron.policies.policy import ImmediatePolicy, Release
from rtron.policies.state_machine import StateMachine, TableEnum, TransitionEffect, TransitionTable
from rtron.policies.state_transfer import PolicyState
from rtron.policies.verdicts import FlowFilter, VerdictCache
from rtron.vocabulary import Decision, PolicySettings, Verdict


class LeasePhase(TableEnum):
    """The states of Lease."""

    FREE = "no flow of the stream holds the lease"
    HELD = "the holder has not been neutral yet"
    ARMED = "the holder's commands pass"


class LeaseInput(TableEnum):
    """What happens to Lease."""

    COMMAND = "a command of the holder that was neutral before"
    NEUTRAL = "a neutral command of a holder that was not"
    MOVING = "another command of a holder that was not"
    REFUSED = "a message of anybody else"
    UNHELD = "a tick that finds no holder"
    GRANTED = "a tick that finds a holder that was not neutral yet"
    CONTINUED = "a tick that finds a holder that was neutral before"


_FREE, _HELD, _ARMED = LeasePhase.FREE, LeasePhase.HELD, LeasePhase.ARMED
TABLE: TransitionTable[LeasePhase, LeaseInput] = {
    (_FREE, LeaseInput.COMMAND): (_FREE, TransitionEffect.NEVER),
    (_FREE, LeaseInput.NEUTRAL): (_FREE, TransitionEffect.NEVER),
    (_FREE, LeaseInput.MOVING): (_FREE, TransitionEffect.NEVER),
    (_FREE, LeaseInput.REFUSED): (_FREE, TransitionEffect.DROP),
    (_FREE, LeaseInput.UNHELD): (_FREE, TransitionEffect.NOTHING),
    (_FREE, LeaseInput.GRANTED): (_HELD, TransitionEffect.NOTHING),
    (_FREE, LeaseInput.CONTINUED): (_FREE, TransitionEffect.NEVER),
    (_HELD, LeaseInput.COMMAND): (_HELD, TransitionEffect.NEVER),
    (_HELD, LeaseInput.NEUTRAL): (_ARMED, TransitionEffect.PASS),
    (_HELD, LeaseInput.MOVING): (_HELD, TransitionEffect.DROP),
    (_HELD, LeaseInput.REFUSED): (_HELD, TransitionEffect.DROP),
    (_HELD, LeaseInput.UNHELD): (_FREE, TransitionEffect.NOTHING),
    (_HELD, LeaseInput.GRANTED): (_HELD, TransitionEffect.NOTHING),
    (_HELD, LeaseInput.CONTINUED): (_HELD, TransitionEffect.NEVER),
    (_ARMED, LeaseInput.COMMAND): (_ARMED, TransitionEffect.PASS),
    (_ARMED, LeaseInput.NEUTRAL): (_ARMED, TransitionEffect.NEVER),
    (_ARMED, LeaseInput.MOVING): (_ARMED, TransitionEffect.NEVER),
    (_ARMED, LeaseInput.REFUSED): (_ARMED, TransitionEffect.DROP),
    (_ARMED, LeaseInput.UNHELD): (_FREE, TransitionEffect.NOTHING),
    (_ARMED, LeaseInput.GRANTED): (_HELD, TransitionEffect.NOTHING),
    (_ARMED, LeaseInput.CONTINUED): (_ARMED, TransitionEffect.NOTHING),
}
_COMMAND = LeaseInput.COMMAND


class Lease(ImmediatePolicy):
    """The holder of the lease passes once it has been neutral, the others are dropped."""

    __slots__ = (
        "_drop",
        "_filter",
        "_flow_of",
        "_grant",
        "_machine",
        "_neutral_since",
        "_owner",
        "_pass",
        "_pass_reason",
        "is_neutral",
        "lease",
    )

    def __init__(self, settings: PolicySettings, lease: CommandLease) -> None:
        """`lease` is that of the group; the policies of its streams share it."""
        self.is_neutral: Callable[[object], bool] = _is_never_neutral
        """Tells whether a message moves nothing; before it is set, none is known to."""
        self._filter = FlowFilter(settings)
        self._flow_of = {flow.publisher: name for name, flow in self._filter.flows.items()}
        self.lease = lease
        """The lease that all flows need."""
        self._pass = VerdictCache(settings, Decision.PASS)
        self._drop = VerdictCache(settings, Decision.DROP)
        self._machine = StateMachine(TABLE, LeasePhase.FREE)
        self._grant: Grant | None = None
        self._owner: str | None = None
        self._pass_reason = ""
        self._neutral_since: dict[str, Grant] = {}
        """The flow that was neutral, with the grant under which it was."""

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Pass the message if its flow holds the lease and has been neutral or is, else drop it."""
        grant = self._neutral_since.get(flow)
        if grant is not None and now < grant.expires_at:
            self._machine.step(_COMMAND)
            return self._pass.get(flow, self._pass_reason)
        self.tick(now)
        refusal = self.refusal(flow, now, message)
        if refusal is None:
            self._arm(flow)
            return self._pass.get(flow, self._pass_reason)
        is_holder = flow == self._owner
        self._machine.step(LeaseInput.MOVING if is_holder else LeaseInput.REFUSED)
        return refusal

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return the refusal of a flow that does not hold the lease, or must be neutral first.

        Without a message a holder that has not been neutral is refused too: it moves nothing.
        """
        if flow not in self._filter.flows:
            return self._filter.refusal(flow)
        grant = self.lease.grant(now)
        if grant is None or self._flow_of.get(grant.holder.name) != flow:
            return self._drop.get(flow, self.lease.holder_text(now))
        if self._neutral_since.get(flow) is grant:
            return None
        if message is not None and self.is_neutral(message):
            return None
        return self._drop.get(flow, f"{grant.holder} must send a neutral command first")

    def forget_flow(self, flow: str, now: int) -> None:  # noqa: ARG002
        """Let the holder pass again only after a neutral command."""
        if self._neutral_since.pop(flow, None):
            self._machine.step(LeaseInput.GRANTED)

    def tick(self, now: int) -> Sequence[Release]:
        """Find the holder at `now`; nothing is ever held."""
        grant = self.lease.grant(now)
        if grant is not self._grant:
            self._grant = grant
            self._owner = self._flow_of.get(grant.holder.name) if grant else None
            self._pass_reason = self.lease.holder_text(now)
            self._neutral_since = {}
        held = LeaseInput.CONTINUED if self._neutral_since else LeaseInput.GRANTED
        self._machine.step(LeaseInput.UNHELD if self._owner is None else held)
        return ()

    def deadline(self) -> int | None:
        """Return when the grant ends; a time that has come if there is another."""
        if self.lease.latest_grant is not self._grant:
            return 0
        return self._grant.expires_at if self._grant else None

    def export_state(self, now: int) -> PolicyState:
        """Return under which grant the holder has been neutral."""
        self.tick(now)
        grant = self._grant if self._neutral_since else None
        return PolicyState(neutral_grant=grant.number if grant else None)

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Let a holder go on that has been neutral under this grant; let go what waited."""
        self.tick(now)
        if self._owner and self._grant and self._grant.number == state.neutral_grant:
            self._arm(self._owner)
        return self._filter.release_held(state.held_messages)

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._filter, self._pass, self._drop):
            each.revise(revision)

    @property
    def owner(self) -> str | None:
        """The flow that holds the lease, as of the last message or tick."""
        return self._owner

    def _arm(self, flow: str) -> None:
        if self._grant is None:
            raise AssertionError("nobody is neutral without a grant")
        self._neutral_since = {flow: self._grant}
        self._machine.step(LeaseInput.NEUTRAL)


def _is_never_neutral(_message: object) -> bool:
    return False

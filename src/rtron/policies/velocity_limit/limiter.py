"""What Safe and Constrain have in common: a velocity is at most the limit, whoever asks for it.

A message here is a `Velocity`, or a text that says why it is none. One above the limit goes on
changed: it is scaled as a whole, so that the curvature stays. NaN and Inf are dropped. On the topic
of a maximal velocity (`reissues`), where nobody need speak again, what was asked for last goes out
once more when the limit changes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from rtron.policies.active_flows import ActiveFlows
from rtron.policies.policy import ImmediatePolicy, Release
from rtron.policies.state_machine import StateMachine, TableEnum, TransitionEffect, TransitionTable
from rtron.policies.state_transfer import PolicyState, VelocityRequest
from rtron.policies.velocity_limit.motion_bounds import AccelerationLimit, MotionBounds
from rtron.policies.verdicts import (
    FlowFilter,
    VerdictCache,
    check_priorities,
    owns_output_reason,
    with_priority,
)
from rtron.vocabulary import SECOND, UNAPPROVED, Decision, PolicySettings, Velocity, Verdict

REISSUE_PERIOD = SECOND // 10


@dataclass(frozen=True, slots=True)
class SpeedLimit:
    """A speed (m/s) that is not to be exceeded, and why."""

    speed: float
    reason: str


class LimitSource(Protocol):
    """Tells the limit of the moment."""

    def at(self, now: int) -> SpeedLimit:
        """Return the limit at `now`."""

    @property
    def is_variable(self) -> bool:
        """Whether the limit ever changes."""


class LimitState(TableEnum):
    """The states of a limit."""

    WITHIN = "what was asked for last is within the limit"
    LIMITED = "what was asked for last is above the limit"


class LimitInput(TableEnum):
    """What happens to a limit."""

    BELOW = "a velocity within the limit"
    ABOVE = "a velocity above the limit"
    INVALID = "NaN, Inf, or what is no velocity at all"
    REST = "a velocity while nothing may move"
    LOWER = "a message while a flow of higher priority is fresh"
    REFUSED = "a message of a blocked or unknown flow"
    CHANGED = "the limit changes what goes on"
    FREED = "the limit is no longer below what was asked for"


TABLE: TransitionTable[LimitState, LimitInput] = {
    (LimitState.WITHIN, LimitInput.BELOW): (LimitState.WITHIN, TransitionEffect.PASS),
    (LimitState.WITHIN, LimitInput.ABOVE): (LimitState.LIMITED, TransitionEffect.MODIFY),
    (LimitState.WITHIN, LimitInput.INVALID): (LimitState.WITHIN, TransitionEffect.DROP),
    (LimitState.WITHIN, LimitInput.REST): (LimitState.WITHIN, TransitionEffect.DROP),
    (LimitState.WITHIN, LimitInput.LOWER): (LimitState.WITHIN, TransitionEffect.DROP),
    (LimitState.WITHIN, LimitInput.REFUSED): (LimitState.WITHIN, TransitionEffect.DROP),
    (LimitState.WITHIN, LimitInput.CHANGED): (LimitState.LIMITED, TransitionEffect.REISSUE),
    (LimitState.WITHIN, LimitInput.FREED): (LimitState.WITHIN, TransitionEffect.NEVER),
    (LimitState.LIMITED, LimitInput.BELOW): (LimitState.WITHIN, TransitionEffect.PASS),
    (LimitState.LIMITED, LimitInput.ABOVE): (LimitState.LIMITED, TransitionEffect.MODIFY),
    (LimitState.LIMITED, LimitInput.INVALID): (LimitState.LIMITED, TransitionEffect.DROP),
    (LimitState.LIMITED, LimitInput.REST): (LimitState.LIMITED, TransitionEffect.DROP),
    (LimitState.LIMITED, LimitInput.LOWER): (LimitState.LIMITED, TransitionEffect.DROP),
    (LimitState.LIMITED, LimitInput.REFUSED): (LimitState.LIMITED, TransitionEffect.DROP),
    (LimitState.LIMITED, LimitInput.CHANGED): (LimitState.LIMITED, TransitionEffect.REISSUE),
    (LimitState.LIMITED, LimitInput.FREED): (LimitState.WITHIN, TransitionEffect.REISSUE),
}


@dataclass(slots=True)
class _Request:
    """The velocity that was asked for last, and what of it goes on."""

    flow: str
    requested: Velocity
    sent: Velocity


class VelocityLimiter(ImmediatePolicy):
    """Changes velocities above the limit; drops what cannot be judged."""

    def __init__(self, settings: PolicySettings, source: LimitSource) -> None:
        self._filter = FlowFilter(settings)
        self._source = source
        self._bounds = MotionBounds(settings)
        self._acceleration = AccelerationLimit(settings)
        self._pass = VerdictCache(settings, Decision.PASS)
        self._drop = VerdictCache(settings, Decision.DROP)
        self._modify = VerdictCache(settings, Decision.MODIFY)
        self._machine = StateMachine(TABLE, LimitState.WITHIN)
        self._active_flows = self._by_priority(settings)
        self._last_message_times: dict[str, int] = {}
        self._last_request: _Request | None = None
        self._due: int | None = None
        self._now = 0
        self.reissues = False

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Pass the velocity if it is within the limit at `now`, otherwise change it."""
        self._now = now
        if flow not in self._filter.flows:
            self._machine.step(LimitInput.REFUSED)
            return self._filter.refusal(flow)
        if not isinstance(message, Velocity) or not message.is_finite:
            self._machine.step(LimitInput.INVALID)
            why = message if isinstance(message, str) else "NaN or Inf is no velocity"
            return self._drop.create(flow, why, error=True)
        if reason := self._higher_flow_reason(flow, now):
            self._machine.step(LimitInput.LOWER)
            return self._drop.get(flow, reason)
        return self._limit_velocity(flow, message, now)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:  # noqa: ARG002
        """Return what any velocity of `flow` is refused with now: blocked, or the limit is 0."""
        if flow not in self._filter.flows:
            return self._filter.refusal(flow)
        limit = self._source.at(now)
        return (
            self._drop.get(flow, _stopped_reason(limit)) if self._stops_everything(limit) else None
        )

    def limit(self, now: int) -> float:
        """Return the speed (m/s) that is not to be exceeded at `now`."""
        return self._source.at(now).speed

    def bounded(self, velocity: Velocity, now: int) -> Velocity:
        """Return what of a velocity in force may go on at `now`."""
        return self._within_limits(velocity, self._source.at(now))[0]

    def note_sent(self, velocity: Velocity, now: int) -> None:
        """Note that the guard itself has sent a velocity at `now`, to slow or stop the robot."""
        self._acceleration.note_sent(velocity, now)

    def forget_flow(self, flow: str, now: int) -> None:
        """Let the lower flows speak at once."""
        if self._active_flows:
            self._active_flows.forget(flow, now)

    def tick(self, now: int) -> Sequence[Release]:
        """Let what was asked for last go out again if the limit has changed."""
        self._now = now
        request, due = self._last_request, self.deadline()
        if request is None or due is None or now < due:
            return ()
        self._schedule_check(now)
        if not self.reissues:
            return ()
        velocity, reason = self._within_limits(request.requested, self._source.at(now))
        if velocity == request.sent:
            return ()
        self._machine.step(
            LimitInput.FREED if velocity is request.requested else LimitInput.CHANGED
        )
        restores, request.sent = velocity.speed > request.sent.speed, velocity
        return (Release(velocity, self._modified_verdict(request, reason), restores),)

    def reevaluate(self, now: int) -> None:
        """Look at what was asked for last again, all of which has gone on meanwhile."""
        if self._last_request:
            self._last_request.sent = self._last_request.requested
            self._due = now

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return when each fresh flow spoke last, where the flows have an order."""
        return self._active_flows.last_message_times(now) if self._active_flows else {}

    def export_state(self, now: int) -> PolicyState:
        """Return what was asked for last, and who is fresh."""
        request = self._last_request
        return PolicyState(
            last_message_times=self.last_message_times(now)
            if self._active_flows
            else self._last_message_times,
            velocity_request=VelocityRequest(request.flow, request.requested, request.sent)
            if request
            else None,
            last_sent=self._acceleration.last_sent,
        )

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Know who is fresh, and look at once whether the limit changes what was asked for last.

        A flow that is blocked by now gets nothing back.
        """
        self._last_message_times = {
            flow: at for flow, at in state.last_message_times.items() if flow in self._filter.flows
        }
        if self._active_flows:
            self._active_flows.restore(self._last_message_times)
        if state.velocity_request:
            self._adopt_request(state.velocity_request)
            self._acceleration.note_sent(state.velocity_request.sent, now)
            self._due = now
        if state.last_sent:
            self._acceleration.note_sent(*state.last_sent)
        return ()

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._filter, self._pass, self._drop, self._modify):
            each.revise(revision)

    def deadline(self) -> int | None:
        """Return when to look at a changing limit again."""
        return self._due

    @property
    def owner(self) -> str | None:
        """The flow of highest priority, where the flows have an order."""
        activity = self._active_flows.highest_priority(self._now) if self._active_flows else None
        return activity.flow.name if activity else None

    def _adopt_request(self, request: VelocityRequest) -> None:
        requested = request.requested if request.flow in self._filter.flows else request.sent
        self._last_request = _Request(request.flow, requested, request.sent)
        if request.sent != requested:
            self._machine.step(LimitInput.ABOVE)

    def _limit_velocity(self, flow: str, requested: Velocity, now: int) -> Verdict:
        limit = self._source.at(now)
        if self._stops_everything(limit):
            self._machine.step(LimitInput.REST)
            return self._drop.get(flow, _stopped_reason(limit))
        velocity, reason = self._within_limits(requested, limit)
        if not self.reissues:
            velocity, slow_reason = self._acceleration.apply(velocity, now)
            reason = slow_reason or reason
            self._acceleration.note_sent(velocity, now)
        self._last_request = request = _Request(flow, requested, velocity)
        self._schedule_check(now)
        if velocity is requested:
            self._machine.step(LimitInput.BELOW)
            return self._pass.get(flow, f"within {reason}")
        self._machine.step(LimitInput.ABOVE)
        return self._modified_verdict(request, reason)

    def _within_limits(self, requested: Velocity, limit: SpeedLimit) -> tuple[Velocity, str]:
        """Return the velocity within all limits but that of acceleration, and the tightest."""
        velocity, reason = self._bounds.apply(requested.at_most(limit.speed))
        return velocity, reason or limit.reason

    def _schedule_check(self, now: int) -> None:
        self._due = now + REISSUE_PERIOD if self._source.is_variable else None

    def _stops_everything(self, limit: SpeedLimit) -> bool:
        """Tell whether nothing passes: a limit of 0, but for who asks what the limit is."""
        return limit.speed == 0 and not self.reissues

    def _modified_verdict(self, request: _Request, reason: str) -> Verdict:
        relation = "within" if request.sent is request.requested else "limited to"
        return self._modify.create(request.flow, f"{relation} {reason}", request.sent)

    def _higher_flow_reason(self, flow: str, now: int) -> str:
        """Return why a message of `flow` must not go: a flow of higher priority has spoken."""
        if self._active_flows is None:
            self._last_message_times[flow] = now
            return ""
        activity = self._active_flows.by_name[flow]
        self._active_flows.record_message(activity, now)
        highest = self._active_flows.highest_priority(now) or activity
        return (
            ""
            if highest is activity
            else with_priority(highest.flow, owns_output_reason(highest.flow))
        )

    def _by_priority(self, settings: PolicySettings) -> ActiveFlows | None:
        """Return the flows in their order; None where all have the same priority, so no order."""
        approved = (flow for flow in settings.flows if flow.name != UNAPPROVED)
        if len({flow.priority for flow in approved}) <= 1:
            return None
        check_priorities(settings)
        return ActiveFlows(self._filter.flows.values(), lambda _: settings.release_after)


def _stopped_reason(limit: SpeedLimit) -> str:
    return f"nothing moves: {limit.reason}"

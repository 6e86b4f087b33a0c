"""A supervised override: for a while, messages that a node would forbid pass, and are logged."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rtron.guard.core.velocity_adapter import VelocityAdapter
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies.policy import ImmediatePolicy, Policy, Release
from rtron.policies.state_transfer import PolicyState
from rtron.vocabulary import UNAPPROVED, Decision, Velocity, Verdict


@dataclass(frozen=True, slots=True)
class Override:
    """Who overrides a coordination node, why, and until when (ns)."""

    by: str
    why: str
    until: int


class OverridablePolicy(ImmediatePolicy):
    """Wraps a policy that holds no messages; an override lets approved flows pass.

    Messages that cannot be read, and those of unapproved flows, are refused all the same.
    """

    __slots__ = ("_policy", "active_override", "overrides")

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.overrides: Mapping[str, Override] = {}
        """The granted overrides by their channel."""
        self.active_override: Override | None = None
        """The granted override that lasts longest."""

    def grant(self, channel: str, override: Override) -> None:
        """Grant an override, in place of the one before of the same channel."""
        self.overrides = {**self.overrides, channel: override}
        self._select_override()

    def end_override(self, channel: str, now: int) -> None:
        """End the override of a channel at `now` (ns)."""
        if channel in self.overrides:
            self.grant(channel, replace(self.overrides[channel], until=now))

    def inherit_overrides(self, predecessor: "OverridablePolicy") -> None:
        """Take over the overrides of the policy that this one replaces."""
        self.overrides = predecessor.overrides
        self._select_override()

    def learn(self, codec: VelocityCodec) -> None:
        """Give the codec to a policy that reads velocities."""
        if isinstance(self._policy, VelocityAdapter):
            self._policy.learn(codec)

    def reevaluate(self, now: int) -> None:
        """Evaluate the last request again: its result may have changed."""
        if isinstance(self._policy, VelocityAdapter):
            self._policy.reevaluate(now)

    def limit(self, now: int) -> float | None:
        """Return the speed (m/s) that the policy allows now; None if it sets none."""
        if self._is_overridden(now) or not isinstance(self._policy, VelocityAdapter):
            return None
        return self._policy.limit(now)

    def bounded(self, velocity: Velocity, now: int) -> Velocity:
        """Return what of a velocity in force the policy allows now."""
        if self._is_overridden(now) or not isinstance(self._policy, VelocityAdapter):
            return velocity
        return self._policy.bounded(velocity, now)

    def note_sent(self, velocity: Velocity, now: int) -> None:
        """Tell the policy what the guard itself has sent."""
        if isinstance(self._policy, VelocityAdapter):
            self._policy.note_sent(velocity, now)

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Return the policy's verdict, or a pass by the override."""
        verdict = self._policy.verdict(flow, message, now)
        if self.active_override is None or verdict.decision is Decision.PASS:
            return verdict
        return self._apply_override(verdict, self.active_override, now)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return the policy's refusal, unless it is overridden."""
        refusal = self._policy.refusal(flow, now, message)
        if refusal is None or self.active_override is None:
            return refusal
        overridden = self._apply_override(refusal, self.active_override, now)
        return None if overridden.decision is Decision.PASS else refusal

    def observe_done(self, now: int) -> None:
        """Tell the policy."""
        self._policy.observe_done(now)

    def forget_flow(self, flow: str, now: int) -> None:
        """Tell the policy."""
        self._policy.forget_flow(flow, now)

    def tick(self, now: int) -> Sequence[Release]:
        """Return what the policy releases; nothing while it is overridden."""
        if self._is_overridden(now):
            self._policy.tick(now)
            return ()
        if self.active_override:
            self.reevaluate(now)
        self.overrides, self.active_override = {}, None
        return self._policy.tick(now)

    def close(self) -> Sequence[Release]:
        """Return what the policy drops."""
        return self._policy.close()

    def last_message_times(self, now: int) -> Mapping[str, int]:
        """Return the policy's."""
        return self._policy.last_message_times(now)

    def export_state(self, now: int) -> PolicyState:
        """Return the policy's state."""
        return self._policy.export_state(now)

    def restore_state(self, state: PolicyState, now: int) -> Sequence[Release]:
        """Let the policy go on."""
        return self._policy.restore_state(state, now)

    def revise(self, revision: int) -> None:
        """Tell the policy."""
        self._policy.revise(revision)

    def deadline(self) -> int | None:
        """Return when (ns) the policy must tick again or the override ends."""
        due = self._policy.deadline()
        if self.active_override is None:
            return due
        return self.active_override.until if due is None else min(due, self.active_override.until)

    @property
    def owner(self) -> str | None:
        """The policy's owner."""
        return self._policy.owner

    def _is_overridden(self, now: int) -> bool:
        return self.active_override is not None and now < self.active_override.until

    def _select_override(self) -> None:
        overrides = self.overrides.values()
        self.active_override = max(overrides, key=lambda override: override.until, default=None)

    def _apply_override(self, verdict: Verdict, override: Override, now: int) -> Verdict:
        if now >= override.until or verdict.error or verdict.flow == UNAPPROVED:
            return verdict
        reason = f"overridden by {override.by} ({override.why}): {verdict.reason}"
        return Verdict(Decision.PASS, verdict.flow, verdict.policy, reason, verdict.revision)

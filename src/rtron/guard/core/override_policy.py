"""A supervised override: for a while, what a coordination node would forbid passes, and is told."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from rtron.guard.core.velocity_adapter import Decoding
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies.policy import Immediate, Policy, Release
from rtron.policies.state_transfer import Carried
from rtron.vocabulary import UNAPPROVED, Decision, Verdict


@dataclass(frozen=True, slots=True)
class Override:
    """Who lets what pass, why, and until when (ns)."""

    by: str
    why: str
    until: int


class Overridable(Immediate):
    """Stands before a policy that holds no messages; an override lets approved flows pass.

    What cannot be judged, and who is not approved, is refused all the same.
    """

    __slots__ = ("_policy", "granted", "override")

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.granted: Mapping[str, Override] = {}
        """What was granted, by the way it was asked for."""
        self.override: Override | None = None
        """Of what was granted, what lasts longest."""

    def grant(self, way: str, override: Override) -> None:
        """Let pass as `override` says, in place of what was granted the same way before."""
        self.granted = {**self.granted, way: override}
        self._choose()

    def end(self, way: str, now: int) -> None:
        """Let what was granted one way be over by `now`."""
        if way in self.granted:
            self.grant(way, replace(self.granted[way], until=now))

    def take_over(self, other: "Overridable") -> None:
        """Be overridden as the one was in whose place this stands now."""
        self.granted = other.granted
        self._choose()

    def learn(self, codec: VelocityCodec) -> None:
        """Tell a policy that looks into messages how these are laid out."""
        if isinstance(self._policy, Decoding):
            self._policy.learn(codec)

    def again(self, now: int) -> None:
        """Look at what was asked for last again: what was to go out may have been held up."""
        if isinstance(self._policy, Decoding):
            self._policy.again(now)

    def limit(self, now: int) -> float | None:
        """Return the speed (m/s) that the policy allows now; None if it sets none."""
        overridden = self.override is not None and now < self.override.until
        if overridden or not isinstance(self._policy, Decoding):
            return None
        return self._policy.limit(now)

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Return the policy's verdict, or that it is overridden."""
        verdict = self._policy.verdict(flow, message, now)
        if self.override is None or verdict.decision is Decision.PASS:
            return verdict
        return self._overridden(verdict, self.override, now)

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return the policy's refusal, unless it is overridden."""
        refusal = self._policy.refusal(flow, now, message)
        if refusal is None or self.override is None:
            return refusal
        overridden = self._overridden(refusal, self.override, now)
        return None if overridden.decision is Decision.PASS else refusal

    def observe_done(self, now: int) -> None:
        """Tell the policy."""
        self._policy.observe_done(now)

    def tick(self, now: int) -> Sequence[Release]:
        """Return what the policy lets go; nothing while it is overridden."""
        if self.override and now < self.override.until:
            self._policy.tick(now)
            return ()
        if self.override:
            self.again(now)
        self.granted, self.override = {}, None
        return self._policy.tick(now)

    def close(self) -> Sequence[Release]:
        """Return what the policy gives up."""
        return self._policy.close()

    def carry(self, now: int) -> Carried:
        """Return the policy's state."""
        return self._policy.carry(now)

    def resume(self, carried: Carried, now: int) -> Sequence[Release]:
        """Let the policy go on."""
        return self._policy.resume(carried, now)

    def revise(self, revision: int) -> None:
        """Tell the policy."""
        self._policy.revise(revision)

    def deadline(self) -> int | None:
        """Return when the policy wants to be asked again, or the override ends."""
        due = self._policy.deadline()
        if self.override is None:
            return due
        return self.override.until if due is None else min(due, self.override.until)

    @property
    def owner(self) -> str | None:
        """The policy's owner."""
        return self._policy.owner

    def _choose(self) -> None:
        granted = self.granted.values()
        self.override = max(granted, key=lambda override: override.until, default=None)

    def _overridden(self, verdict: Verdict, override: Override, now: int) -> Verdict:
        if now >= override.until or verdict.error or verdict.flow == UNAPPROVED:
            return verdict
        told = f"overridden by {override.by} ({override.why}): {verdict.reason}"
        return Verdict(Decision.PASS, verdict.flow, verdict.policy, told, verdict.revision)

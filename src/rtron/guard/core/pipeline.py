"""A pipeline: each message enters once and leaves once, whatever the number of stages.

It does no I/O: messages that pass go to `emit`, and the time is an argument.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rtron.guard.core.velocity_gate import VelocityGate
from rtron.policies.state_transfer import LeaseState
from rtron.vocabulary import Decision, PolicyName, Verdict

if TYPE_CHECKING:
    from rtron.policies.policy import Policy, Release
    from rtron.policies.state_transfer import PolicyState

_PASS, _DROP, _MODIFY = Decision.PASS, Decision.DROP, Decision.MODIFY
Emit = Callable[[str, bytes, int], None]
"""Takes the flow, a message that every stage has passed, and the time (ns)."""


@dataclass(slots=True)
class VerdictTally:
    """The number of verdicts on one flow's messages; `last` is the newest verdict."""

    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0
    last: Verdict | None = None


class Pipeline:
    """The policies of one stream, asked in the order of its stages.

    A message that a later stage would refuse does not reach the earlier ones: it must not take the
    output from others, nor wait in a queue. When its turn has come, the later stages decide again.
    `on_verdict_change`, if set, is called with each verdict that differs from the one before on its
    flow; `on_dropped` with each message that was held and is dropped.
    """

    def __init__(
        self,
        policies: Sequence["Policy"],
        flows: Sequence[str],
        emit: Emit,
        gate: VelocityGate,
    ) -> None:
        """Each message goes through `gate` before a policy sees it."""
        self.policies = tuple(policies)
        self.tallies: dict[str, VerdictTally] = {flow: VerdictTally() for flow in flows}
        self._emit = emit
        self._gate = gate
        self._policies_from = _policy_suffixes(self.policies)
        self._bars: dict[tuple[str, str], Verdict] = {}
        self._revision = 0
        self.last_emitted: tuple[str, bytes, int] | None = None
        self.on_verdict_change: Callable[[Verdict], None] | None = None
        self.on_dropped: Callable[[bytes, Verdict], None] = _ignore_dropped

    def receive(self, flow: str, message: bytes, now: int) -> Verdict:
        """Decide about a message that arrived at `now` (ns); emit it if all stages pass it."""
        entry = self._bar_on(flow) or self._gate.verdict(flow, message)
        if entry and entry.decision is _MODIFY:
            message = entry.message  # type: ignore[assignment]
        refusal = entry if entry and entry.decision is _DROP else None
        for later in self._policies_from[1]:
            refusal = refusal or later.refusal(flow, now, message)
        if refusal is not None:
            self._count(refusal)
            return refusal
        return self._run_stages(0, flow, message, now, entry)

    def replace(self, at: int, policy: "Policy", now: int) -> Sequence["Release"]:
        """Replace the policy of the stage `at`; return held messages that the new one cannot hold.

        An action that a policy without turns has passed is in progress all the same.
        """
        before = self.policies[at]
        carried = self._with_turn(before.export_state(now))
        dropped = (*before.close(), *policy.restore_state(carried, now))
        self.policies = (*self.policies[:at], policy, *self.policies[at + 1 :])
        self._policies_from = _policy_suffixes(self.policies)
        return dropped

    def drop_held(self, releases: Iterable["Release"]) -> None:
        """Report held messages that are dropped."""
        for release in releases:
            self._count(release.verdict)
            self.on_dropped(release.message, release.verdict)  # type: ignore[arg-type]

    def revise(self, revision: int) -> None:
        """Give verdicts with the settings' `revision` from now on."""
        self._revision = revision
        self._gate.revise(revision)
        for policy in self.policies:
            policy.revise(revision)
        self._bars = {key: replace(bar, revision=revision) for key, bar in self._bars.items()}

    def tick(self, now: int) -> None:
        """Let time pass; messages that a stage releases go on to the next stages."""
        for at, policy in enumerate(self.policies):
            for release in policy.tick(now):
                self._release(at, release, now)

    def finish_action(self, now: int) -> None:
        """Learn that the action in progress is done."""
        self.last_emitted = None
        for policy in self.policies:
            policy.observe_done(now)
        self.tick(now)

    def occupy(self, flow: str, now: int) -> None:
        """Learn that an action is in progress which did not come through the pipeline."""
        self.last_emitted = (flow, b"", now)
        for policy in self.policies:
            policy.occupy(flow, now)

    def forget_flow(self, flow: str, now: int) -> None:
        """Learn that nobody speaks for a flow any more; what waited behind it may go."""
        for policy in self.policies:
            policy.forget_flow(flow, now)
        self.tick(now)

    def withdraw(self, message: bytes, why: str, now: int) -> None:
        """Drop a message that is held."""
        for policy in self.policies:
            policy.withdraw(message, why)
        self.tick(now)

    def refusal(self, flow: str, now: int, message: bytes | None = None) -> str:
        """Return why `message`, or any message of `flow`, would be refused at `now` (ns), or ""."""
        refusals = (policy.refusal(flow, now, message) for policy in self.policies)
        refusal = self._bar_on(flow) or next(filter(None, refusals), None)
        return refusal.reason if refusal else ""

    def bar(self, by: str, flows: Iterable[str], why: str) -> None:
        """Drop all messages of these flows until `unbar(by)`, whatever the policies decide."""
        for flow in flows:
            reason = Verdict(_DROP, flow, PolicyName.BLOCK, why, self._revision)
            self._bars[by, flow] = reason

    def unbar(self, by: str) -> None:
        """Remove all bars of `by`."""
        self._bars = {key: verdict for key, verdict in self._bars.items() if key[0] != by}

    def deadline(self) -> int | None:
        """Return when (ns) `tick` next has something to do, or None."""
        times = [due for policy in self.policies if (due := policy.deadline()) is not None]
        return min(times, default=None)

    def _bar_on(self, flow: str) -> Verdict | None:
        if not self._bars:
            return None
        return next((verdict for verdict in self._bars.values() if verdict.flow == flow), None)

    @property
    def owner(self) -> str | None:
        """The flow that has the output."""
        return self.policies[0].owner if self.policies else None

    def _release(self, at: int, release: "Release", now: int) -> None:
        """Pass on a message that the stage `at` releases; an earlier stage may refuse it now.

        A refused message is in progress nowhere, so that it does not hold up the others.
        """
        verdict, message = release.verdict, release.message
        if verdict.decision is _DROP:
            self._count(verdict)
        else:
            verdict = self._pass_release(at, release, now)
            if verdict.decision is _DROP:
                self.policies[at].observe_done(now)
        if verdict.decision is _DROP:
            self.on_dropped(message, verdict)  # type: ignore[arg-type]

    def _pass_release(self, at: int, release: "Release", now: int) -> Verdict:
        verdict, flow = release.verdict, release.verdict.flow
        earlier = self.policies[:at] if release.restores else ()
        refusals = (policy.refusal(flow, now) for policy in earlier)
        refusal = self._bar_on(flow) or next(filter(None, refusals), None)
        if refusal is None:
            return self._run_stages(at + 1, flow, release.message, now, verdict)  # type: ignore[arg-type]
        self._count(refusal)
        return refusal

    def _run_stages(
        self, first: int, flow: str, message: bytes, now: int, verdict: Verdict | None = None
    ) -> Verdict:
        """Ask the stages from `first` on; `verdict` is that of the stages before."""
        for policy in self._policies_from[first]:
            stage_verdict = policy.verdict(flow, message, now)
            if stage_verdict.decision is _MODIFY:
                message = stage_verdict.message  # type: ignore[assignment]
            elif stage_verdict.decision is not _PASS:
                self._count(stage_verdict)
                return stage_verdict
            if verdict is None or verdict.decision is not _MODIFY:
                verdict = stage_verdict
        if verdict is None:
            raise AssertionError("a pipeline has a stage")
        self.last_emitted = (flow, message, now)
        self._emit(flow, message, now)
        self._count(verdict)
        return verdict

    def _with_turn(self, carried: "PolicyState") -> "PolicyState":
        """Add the last output, which the policy may not know."""
        if self.last_emitted is None:
            return carried
        flow, message, at = self.last_emitted
        turn = carried.lease if carried.has_lease else LeaseState(flow, at, at)
        return replace(carried, lease=turn, last_output=(flow, message))

    def _count(self, verdict: Verdict) -> None:
        tally = self.tallies[verdict.flow]
        if self.on_verdict_change and verdict is not tally.last and _differs(verdict, tally.last):
            self.on_verdict_change(verdict)
        decision = verdict.decision
        if decision is _PASS:
            tally.passed += 1
        elif decision is _DROP:
            tally.dropped += 1
        elif decision is _MODIFY:
            tally.modified += 1
        else:
            tally.held += 1
        tally.last = verdict


def _policy_suffixes(policies: Sequence["Policy"]) -> list[tuple["Policy", ...]]:
    """Return for each stage the policies from it on, and an empty tuple after the last."""
    return [tuple(policies[at:]) for at in range(len(policies) + 1)]


def _differs(verdict: Verdict, previous: Verdict | None) -> bool:
    """Return whether the outcome has changed; another limit alone is no change."""
    if (
        previous is None
        or verdict.decision is not previous.decision
        or verdict.policy is not previous.policy
    ):
        return True
    return verdict.decision is not _MODIFY and verdict.reason != previous.reason


def _ignore_dropped(_message: bytes, _verdict: Verdict) -> None:
    """Do nothing with a dropped message."""

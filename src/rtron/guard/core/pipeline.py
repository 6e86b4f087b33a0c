"""A pipeline: one message enters once and leaves once, whatever the number of stages.

Sans-I/O: what is let go is handed to `emit`; time is passed in.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rtron.policies.state_transfer import InTurn
from rtron.vocabulary import Decision, PolicyName, Verdict

if TYPE_CHECKING:
    from rtron.policies.policy import Policy, Release
    from rtron.policies.state_transfer import Carried

Emit = Callable[[str, bytes, int], None]
"""Takes the flow, the message that every stage let go, and the time (ns)."""


@dataclass(slots=True)
class Tally:
    """What became of one flow's messages; `last` is the newest verdict."""

    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0
    last: Verdict | None = None


class Pipeline:
    """The policies of one stream, asked in the order of its stages.

    What a later stage would refuse is not put to the earlier ones: what may not pass must not take
    the output from others, nor wait in a queue. It is asked again when its turn has come.
    `changed`, if it is set, is told a verdict that differs from the one before on its flow;
    `gave_up` each message that was held and will not go.
    """

    def __init__(self, policies: Sequence["Policy"], flows: Sequence[str], emit: Emit) -> None:
        self.policies = tuple(policies)
        self.tallies: dict[str, Tally] = {flow: Tally() for flow in flows}
        self._emit = emit
        self._after = _rests(self.policies)
        self._bars: dict[tuple[str, str], Verdict] = {}
        self._revision = 0
        self._went: tuple[str, bytes, int] | None = None
        self.closed = ""
        self.changed: Callable[[Verdict], None] | None = None
        self.gave_up: Callable[[bytes, Verdict], None] = _forget

    def receive(self, flow: str, message: bytes, now: int) -> Verdict | None:
        """Decide about a message that arrived at `now` (ns); emit it if all stages agree.

        None if the pipeline is shut.
        """
        if self.closed:
            self.tallies[flow].dropped += 1
            return None
        refusal = self._barred(flow)
        for later in self._after[1]:
            refusal = refusal or later.refusal(flow, now, message)
        if refusal is not None:
            self._count(refusal)
            return refusal
        return self._go_on(0, flow, message, now)

    def replace(self, at: int, policy: "Policy", now: int) -> Sequence["Release"]:
        """Let another policy go on in the place of the stage `at`; return what it cannot hold.

        An action that one without turns has let go is in progress all the same.
        """
        before = self.policies[at]
        carried = self._completed(before.carry(now))
        given_up = (*before.close(), *policy.resume(carried, now))
        self.policies = (*self.policies[:at], policy, *self.policies[at + 1 :])
        self._after = _rests(self.policies)
        return given_up

    def give_up(self, releases: Iterable["Release"]) -> None:
        """Tell what was held and will not go."""
        for release in releases:
            self._count(release.verdict)
            self.gave_up(release.message, release.verdict)  # type: ignore[arg-type]

    def revise(self, revision: int) -> None:
        """Give verdicts by settings of `revision` from now on, also where nothing has changed."""
        self._revision = revision
        for policy in self.policies:
            policy.revise(revision)
        self._bars = {key: replace(bar, revision=revision) for key, bar in self._bars.items()}

    def tick(self, now: int) -> None:
        """Let time pass: what a stage releases goes on to the stages after it."""
        for at, policy in enumerate(() if self.closed else self.policies):
            for release in policy.tick(now):
                self._release(at, release, now)

    def done(self, now: int) -> None:
        """Learn that the action in progress is done."""
        self._went = None
        for policy in self.policies:
            policy.observe_done(now)
        self.tick(now)

    def occupy(self, flow: str, now: int) -> None:
        """Learn that an action is in progress that was not let go here."""
        self._went = (flow, b"", now)
        for policy in self.policies:
            policy.occupy(flow, now)

    def withdraw(self, message: bytes, why: str, now: int) -> None:
        """Give up a message that is held."""
        for policy in self.policies:
            policy.withdraw(message, why)
        self.tick(now)

    def refusal(self, flow: str, now: int, message: bytes | None = None) -> str:
        """Return why `message` of `flow`, or none of its messages, would pass at `now`."""
        if self.closed:
            return self.closed
        refusals = (policy.refusal(flow, now, message) for policy in self.policies)
        refusal = self._barred(flow) or next(filter(None, refusals), None)
        return refusal.reason if refusal else ""

    def bar(self, by: str, flows: Iterable[str], why: str) -> None:
        """Let nothing of these flows pass until `by` frees them, whatever the policies say."""
        for flow in flows:
            reason = Verdict(Decision.DROP, flow, PolicyName.BLOCK, why, self._revision)
            self._bars[by, flow] = reason

    def free(self, by: str) -> None:
        """Take back all that `by` has barred."""
        self._bars = {key: verdict for key, verdict in self._bars.items() if key[0] != by}

    def deadline(self) -> int | None:
        """Return when `tick` next has something to do, or None."""
        if self.closed:
            return None
        times = [due for policy in self.policies if (due := policy.deadline()) is not None]
        return min(times, default=None)

    def shut(self, why: str) -> None:
        """Let nothing through any more; what was held is dropped with a verdict."""
        self.closed = why
        for policy in self.policies:
            self.give_up(policy.close())

    def _barred(self, flow: str) -> Verdict | None:
        if not self._bars:
            return None
        return next((verdict for verdict in self._bars.values() if verdict.flow == flow), None)

    @property
    def owner(self) -> str | None:
        """The flow that has the output."""
        return self.policies[0].owner if self.policies and not self.closed else None

    def _release(self, at: int, release: "Release", now: int) -> None:
        """Let what the stage `at` releases go on; a rule of an earlier one may keep it low.

        What is refused now is in progress nowhere: it shall not hold up the others.
        """
        verdict, message = release.verdict, release.message
        if verdict.decision is Decision.DROP:
            self._count(verdict)
        else:
            verdict = self._let_go(at, release, now)
            if verdict.decision is Decision.DROP:
                self.policies[at].observe_done(now)
        if verdict.decision is Decision.DROP:
            self.gave_up(message, verdict)  # type: ignore[arg-type]

    def _let_go(self, at: int, release: "Release", now: int) -> Verdict:
        verdict, flow = release.verdict, release.verdict.flow
        earlier = self.policies[:at] if release.restores else ()
        refusals = (policy.refusal(flow, now) for policy in earlier)
        refusal = self._barred(flow) or next(filter(None, refusals), None)
        if refusal is None:
            return self._go_on(at + 1, flow, release.message, now, verdict)  # type: ignore[arg-type]
        self._count(refusal)
        return refusal

    def _go_on(
        self, first: int, flow: str, message: bytes, now: int, verdict: Verdict | None = None
    ) -> Verdict:
        """Ask the stages from `first` on; `verdict` is what those before it said."""
        for policy in self._after[first]:
            given = policy.verdict(flow, message, now)
            if given.decision is Decision.MODIFY:
                message = given.message  # type: ignore[assignment]
            elif given.decision is not Decision.PASS:
                self._count(given)
                return given
            if verdict is None or verdict.decision is not Decision.MODIFY:
                verdict = given
        if verdict is None:
            raise AssertionError("a pipeline has a stage")
        self._went = (flow, message, now)
        self._emit(flow, message, now)
        self._count(verdict)
        return verdict

    def _completed(self, carried: "Carried") -> "Carried":
        """Add what went out last, whatever the policy knows of it."""
        if self._went is None:
            return carried
        flow, message, at = self._went
        turn = carried.turn if carried.turns else InTurn(flow, at, at)
        return replace(carried, turn=turn, last=(flow, message))

    def _count(self, verdict: Verdict) -> None:
        tally = self.tallies[verdict.flow]
        if self.changed and verdict is not tally.last and _differs(verdict, tally.last):
            self.changed(verdict)
        decision = verdict.decision
        if decision is Decision.PASS:
            tally.passed += 1
        elif decision is Decision.DROP:
            tally.dropped += 1
        elif decision is Decision.MODIFY:
            tally.modified += 1
        else:
            tally.held += 1
        tally.last = verdict


def _rests(policies: Sequence["Policy"]) -> list[tuple["Policy", ...]]:
    """Return the policies from each stage on, and none behind the last."""
    return [tuple(policies[at:]) for at in range(len(policies) + 1)]


def _differs(one: Verdict, other: Verdict | None) -> bool:
    """Tell whether what happens has changed; the limit of the moment is no change."""
    if other is None or one.decision is not other.decision or one.policy is not other.policy:
        return True
    return one.decision is not Decision.MODIFY and one.reason != other.reason


def _forget(_message: bytes, _verdict: Verdict) -> None:
    """Nobody waits for an answer."""

"""A pipeline: one message enters once and leaves once, whatever the number of stages.

Sans-I/O: what is let go is handed to `emit`; time is passed in.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.policies import build
from rtron.vocabulary import Decision, Stage, Verdict

if TYPE_CHECKING:
    from rtron.policies.policy import Policy

Emit = Callable[[str, bytes], None]
"""Takes the flow and the message that every stage let go."""


@dataclass(slots=True)
class Tally:
    """What became of one flow's messages; `last` is the newest verdict."""

    passed: int = 0
    held: int = 0
    dropped: int = 0
    last: Verdict | None = None


class Pipeline:
    """The policies of one stream, asked in the order of its stages."""

    def __init__(self, stages: Sequence[Stage], flows: Sequence[str], emit: Emit) -> None:
        self.policies: tuple[Policy, ...] = tuple(build(stage.settings) for stage in stages)
        self.tallies: dict[str, Tally] = {flow: Tally() for flow in flows}
        self._emit = emit
        self.closed = ""

    def receive(self, flow: str, message: bytes, now: int) -> Decision:
        """Decide about a message that arrived at `now` (ns); emit it if all stages agree."""
        if self.closed:
            self.tallies[flow].dropped += 1
            return Decision.DROP
        verdict = self.policies[0].verdict(flow, message, now)
        if verdict.decision is Decision.PASS:
            return self._go_on(1, verdict, message, now)
        self._count(verdict)
        return verdict.decision

    def tick(self, now: int) -> None:
        """Let time pass: what a stage releases goes on to the stages after it."""
        for at, policy in enumerate(() if self.closed else self.policies):
            for release in policy.tick(now):
                if release.verdict.decision is Decision.PASS:
                    self._go_on(at + 1, release.verdict, release.message, now)  # type: ignore[arg-type]
                else:
                    self._count(release.verdict)

    def done(self, now: int) -> None:
        """Learn that the action in progress is done."""
        for policy in self.policies:
            policy.observe_done(now)
        self.tick(now)

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
            for release in policy.close():
                self._count(release.verdict)

    @property
    def owner(self) -> str | None:
        """The flow that has the output."""
        return self.policies[0].owner if self.policies and not self.closed else None

    def _go_on(self, first: int, verdict: Verdict, message: bytes, now: int) -> Decision:
        """Ask the stages from `first` on; `verdict` is what those before it said."""
        flow = verdict.flow
        for policy in self.policies[first:]:
            verdict = policy.verdict(flow, message, now)
            if verdict.decision is not Decision.PASS:
                break
        self._count(verdict)
        if verdict.decision is Decision.PASS:
            self._emit(flow, message)
        return verdict.decision

    def _count(self, verdict: Verdict) -> None:
        tally = self.tallies[verdict.flow]
        decision = verdict.decision
        if decision is Decision.PASS:
            tally.passed += 1
        elif decision is Decision.DROP:
            tally.dropped += 1
        else:
            tally.held += 1
        tally.last = verdict

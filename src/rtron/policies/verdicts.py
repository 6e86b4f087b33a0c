"""The verdicts a policy gives: built once for a flow and a reason, not once a message."""

from collections.abc import Iterable

from rtron.errors import PlanError
from rtron.policies.policy import Release
from rtron.policies.queues.held_messages import HeldMessage
from rtron.vocabulary import SECOND, UNAPPROVED, Decision, Flow, PolicySettings, Verdict


class VerdictCache:
    """The verdicts of one decision; of each flow the last is kept."""

    __slots__ = ("_decision", "_latest", "_policy", "_revision")

    def __init__(self, settings: PolicySettings, decision: Decision) -> None:
        self._decision = decision
        self._policy = settings.policy
        self._revision = settings.revision
        self._latest: dict[str, Verdict] = {}

    def get(self, flow: str, reason: str) -> Verdict:
        """Return the verdict for `flow`, the one given last time if the reason is the same."""
        verdict = self._latest.get(flow)
        if verdict is None or verdict.reason != reason:
            verdict = self._latest[flow] = self.create(flow, reason)
        return verdict

    def revise(self, revision: int) -> None:
        """Give the verdicts of other settings from now on."""
        self._revision = revision
        self._latest.clear()

    def create(
        self, flow: str, reason: str, message: object = None, *, error: bool = False
    ) -> Verdict:
        """Return a verdict that will hardly be given again, without keeping it."""
        return Verdict(self._decision, flow, self._policy, reason, self._revision, message, error)


class FlowFilter:
    """The flows that may speak at all, by name, and the verdict for everyone else."""

    __slots__ = ("_drop", "_reasons", "flows")

    def __init__(self, settings: PolicySettings) -> None:
        self.flows = {flow.name: flow for flow in settings.flows if not flow.block}
        self._drop = VerdictCache(settings, Decision.DROP)
        self._reasons = {UNAPPROVED: _unapproved_reason(UNAPPROVED)}
        for flow in settings.flows:
            if flow.block:
                self._reasons[flow.name] = f"{flow.name} is blocked"

    def refusal(self, flow: str) -> Verdict:
        """Return the verdict for a flow that is blocked or that the settings do not name."""
        reason = self._reasons.get(flow)
        return (
            self._drop.get(flow, reason)
            if reason
            else self._drop.create(flow, _unapproved_reason(flow))
        )

    def revise(self, revision: int) -> None:
        """Give the verdicts of other settings from now on."""
        self._drop.revise(revision)

    def release_held(self, held: Iterable[HeldMessage]) -> list[Release]:
        """Let messages go that waited under a policy before: this one holds none."""
        return [
            Release(message.message, self._release_verdict(message.flow.name)) for message in held
        ]

    def _release_verdict(self, flow: str) -> Verdict:
        if flow not in self.flows:
            return self.refusal(flow)
        return self._drop.get(flow, "the policy has changed, and messages wait no more")


def _unapproved_reason(flow: str) -> str:
    return f"{flow} is not an approved flow"


def check_priorities(settings: PolicySettings) -> None:
    """Refuse flows of equal priority: which of them goes first would be an accident."""
    by_priority: dict[int, str] = {}
    for flow in settings.flows:
        other = by_priority.setdefault(flow.priority, flow.name)
        if other != flow.name:
            raise PlanError(f"{other} and {flow.name} have the same priority {flow.priority}")


def owns_output_reason(flow: Flow) -> str:
    """Return the reason that names the owner of the output."""
    return f"{flow.name} has the output"


def goes_next_reason(flow: Flow) -> str:
    """Return the reason that names whose message goes before."""
    return f"{flow.name} goes next"


def with_priority(flow: Flow, reason: str) -> str:
    """Return a reason about `flow` that also tells its priority."""
    return f"{reason} (priority {flow.priority})"


def format_seconds(duration: int) -> str:
    """Write a duration (ns) as people read it."""
    return f"{duration / SECOND:.2f} s"

"""The verdicts a policy gives: built once for a flow and a reason, not once a message."""

from rtron.errors import PlanError
from rtron.vocabulary import SECOND, UNAPPROVED, Decision, Flow, PolicySettings, Verdict


class Answers:
    """The verdicts of one decision; of each flow the last is kept."""

    __slots__ = ("_decision", "_last", "_policy", "_revision")

    def __init__(self, settings: PolicySettings, decision: Decision) -> None:
        self._decision = decision
        self._policy = settings.policy
        self._revision = settings.revision
        self._last: dict[str, Verdict] = {}

    def give(self, flow: str, reason: str) -> Verdict:
        """Return the verdict for `flow`, the one given last time if the reason is the same."""
        verdict = self._last.get(flow)
        if verdict is None or verdict.reason != reason:
            verdict = self._last[flow] = self.once(flow, reason)
        return verdict

    def once(
        self, flow: str, reason: str, message: object = None, *, error: bool = False
    ) -> Verdict:
        """Return a verdict that will hardly be given again, without keeping it."""
        return Verdict(self._decision, flow, self._policy, reason, self._revision, message, error)


class Gate:
    """The flows that may speak at all, by name, and the verdict for everyone else."""

    __slots__ = ("_drop", "_refused", "flows")

    def __init__(self, settings: PolicySettings) -> None:
        self.flows = {flow.name: flow for flow in settings.flows if not flow.block}
        self._drop = Answers(settings, Decision.DROP)
        self._refused = {UNAPPROVED: self._unknown(UNAPPROVED)}
        for flow in settings.flows:
            if flow.block:
                self._refused[flow.name] = self._drop.once(flow.name, f"{flow.name} is blocked")

    def refusal(self, flow: str) -> Verdict:
        """Return the verdict for a flow that is blocked or that the settings do not name."""
        return self._refused.get(flow) or self._unknown(flow)

    def _unknown(self, flow: str) -> Verdict:
        return self._drop.once(flow, f"{flow} is not an approved flow")


def check_priorities(settings: PolicySettings) -> None:
    """Refuse flows of equal priority: which of them goes first would be an accident."""
    named: dict[int, str] = {}
    for flow in settings.flows:
        other = named.setdefault(flow.priority, flow.name)
        if other != flow.name:
            raise PlanError(f"{other} and {flow.name} have the same priority {flow.priority}")


def has_output(flow: Flow) -> str:
    """Return the reason that names the owner of the output."""
    return f"{flow.name} has the output"


def goes_next(flow: Flow) -> str:
    """Return the reason that names whose message goes before."""
    return f"{flow.name} goes next"


def with_priority(flow: Flow, reason: str) -> str:
    """Return a reason about `flow` that also tells its priority."""
    return f"{reason} (priority {flow.priority})"


def seconds(duration: int) -> str:
    """Write a duration (ns) as people read it."""
    return f"{duration / SECOND:.2f} s"

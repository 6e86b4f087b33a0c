"""Block in an MSRCN: an aflow passes unless a block bit or a rule of the mission forbids it."""

from collections.abc import Callable, Mapping

from rtron.policies.mission.rule_status import MissionMonitor, RuleStatus
from rtron.policies.policy import ImmediatePolicy
from rtron.policies.verdicts import FlowFilter, VerdictCache
from rtron.vocabulary import Decision, PolicySettings, Verdict

RuleResult = bool | str
"""Whether an expression holds for a message, or why that cannot be told."""
RuleEvaluator = Callable[[object], Mapping[str, RuleResult]]
"""Judges a message by the `action` of each rule, by the rule's name."""


class RuleBlock(ImmediatePolicy):
    """The rules that concern one topic; `evaluate` looks into its messages where a rule asks.

    A message is looked into once, however many rules ask and however often.
    """

    __slots__ = (
        "_drop",
        "_evaluate",
        "_evaluated_message",
        "_filter",
        "_mission",
        "_pass",
        "_reasons",
        "_results",
        "_rules",
    )

    def __init__(
        self,
        settings: PolicySettings,
        mission: MissionMonitor,
        evaluate: RuleEvaluator,
        statuses: Mapping[str, RuleStatus] | None = None,
    ) -> None:
        """`statuses` are those of the mission, or what they will be."""
        statuses = mission.statuses if statuses is None else statuses
        self._filter = FlowFilter(settings)
        self._drop = VerdictCache(settings, Decision.DROP)
        self._pass = VerdictCache(settings, Decision.PASS)
        self._reasons = {name: f"no rule blocks {name}" for name in self._filter.flows}
        self._mission = mission
        self._evaluate = evaluate
        self._evaluated_message: object = None
        self._results: Mapping[str, RuleResult] = {}
        self._rules: dict[str, tuple[RuleStatus, ...]] = {
            flow: tuple(
                statuses[rule.name] for rule in settings.rules if flow in rule.blocked_flows
            )
            for flow in self._filter.flows
        }

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Drop the message if a rule that holds at `now` blocks it."""
        refusal = self.refusal(flow, now, message)
        return refusal or self._pass.get(flow, self._reasons[flow])

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return what a message is dropped with: a bit, or a rule that blocks."""
        if flow not in self._reasons:
            return self._filter.refusal(flow)
        self._mission.update_if_due(now)
        for status in self._rules[flow]:
            if status.is_blocking and (result := self._rule_result(status, message)) is not False:
                return self._drop_verdict(flow, status, result)
        return None

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._filter, self._pass, self._drop):
            each.revise(revision)

    def _rule_result(self, status: RuleStatus, message: object) -> RuleResult:
        """Return what a rule says about a message; without one, only whether it blocks all."""
        if not status.rule.action:
            return True
        if message is None:
            return False
        if message is not self._evaluated_message:
            self._evaluated_message, self._results = message, self._evaluate(message)
        return self._results.get(status.rule.name, True)

    def _drop_verdict(self, flow: str, status: RuleStatus, result: RuleResult) -> Verdict:
        if result is True:
            return self._drop.get(flow, status.reason)
        return self._drop.create(flow, f"{status.reason} ({result})", error=True)

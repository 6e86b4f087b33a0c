"""The rules of the mission under settings: which count, what they block, and when."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtron.guard.core.observations import Observations
from rtron.guard.settings.action_judges import ActionEvaluators
from rtron.messages.expressions.condition import Condition
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import MissionRule, Plan


@dataclass(frozen=True, slots=True)
class RuleChange:
    """Other rules, ready to be put in force: what judges messages by them, and how they stand."""

    observations: Observations
    rule_statuses: dict[str, RuleStatus]
    rules: tuple[tuple[MissionRule, Condition], ...]


class MissionRules:
    """Puts rules in force in the mission that all streams share."""

    def __init__(self, plan: Plan, observations: Observations) -> None:
        self._observations = observations
        self._evaluators = ActionEvaluators(plan, observations.actions)
        self._planned_conditions = conditions_by_text(observations.mission.statuses)

    def prepare(self, plan: Plan) -> RuleChange:
        """Return the rules of a plan, nothing changes yet; InputError if they cannot be."""
        evaluators = self._evaluators.for_mission(plan.msrcn)
        conditions = self._planned_conditions | conditions_by_text(
            self._observations.mission.statuses
        )
        plan_rules = plan.msrcn.rules if plan.msrcn else ()
        rules = tuple((rule, self._condition(rule.when, conditions)) for rule in plan_rules)
        rule_statuses = self._observations.mission.prepare_rules(rules)
        return RuleChange(replace(self._observations, actions=evaluators), rule_statuses, rules)

    def apply(self, change: RuleChange, now: int) -> None:
        """Put rules in force."""
        self._observations.mission.replace_rules(change.rule_statuses, change.rules, now)

    def _condition(self, text: str, conditions: Mapping[str, Condition]) -> Condition:
        return conditions.get(text) or Condition(text, self._observations.mission.bits.by_name)


def conditions_by_text(rule_statuses: Mapping[str, RuleStatus]) -> dict[str, Condition]:
    """Return the conditions of rules that have been read already."""
    conditions = (rule_status.condition for rule_status in rule_statuses.values())
    return {each.text: each for each in conditions if isinstance(each, Condition)}

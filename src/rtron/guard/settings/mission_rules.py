"""The mission's rules under settings: which are selected, what they block, and when."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from rtron.guard.core.observations import (
    ActionEvaluator,
    EvaluatorFactory,
    Observations,
    action_evaluator,
    rules_reading,
)
from rtron.messages.expressions.condition import Condition
from rtron.policies.mission.rule_block import RuleResult
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import MSRCN, GuardedTopic, MissionRule, Plan, normalise_type


class ActionEvaluators:
    """The evaluators of a plan's topics, and one for each rule that any topic of its type can use.

    Compiling takes milliseconds, in which messages wait. So each rule is compiled once, and
    beforehand for the type that it is written for.
    """

    def __init__(self, plan: Plan, planned: Mapping[str, ActionEvaluator]) -> None:
        self._planned = planned
        self._rule_evaluators: dict[tuple[str, str], ActionEvaluator] = {}
        self._plan = plan
        for topic, rules in _topics_with_rules(plan.msrcn):
            for rule in rules:
                self._rule_evaluator(topic, rule)

    def for_mission(self, msrcn: MSRCN | None) -> dict[str, ActionEvaluator]:
        """Return the evaluator of each topic that rules read; InputError if one is invalid."""
        return {
            topic.topic: self._topic_evaluator(topic, rules)
            for topic, rules in _topics_with_rules(msrcn)
        }

    @cached_property
    def _factory(self) -> EvaluatorFactory:
        if self._plan.msrcn is None:
            raise AssertionError("there are no rules without an MSRCN")
        return EvaluatorFactory(self._plan, self._plan.msrcn)

    def _topic_evaluator(
        self, topic: GuardedTopic, rules: Sequence[MissionRule]
    ) -> ActionEvaluator:
        planned = self._planned.get(topic.topic)
        planned_rules = planned.rules if planned else ()
        additional = [
            self._rule_evaluator(topic, rule) for rule in rules if rule.name not in planned_rules
        ]
        return _combined([planned, *additional] if planned else additional)

    def _rule_evaluator(self, topic: GuardedTopic, rule: MissionRule) -> ActionEvaluator:
        key = (normalise_type(topic.type), rule.name)
        if key not in self._rule_evaluators:
            self._rule_evaluators[key] = action_evaluator(topic, [rule], self._factory)
        return self._rule_evaluators[key]


def _topics_with_rules(msrcn: MSRCN | None) -> Iterator[tuple[GuardedTopic, list[MissionRule]]]:
    if msrcn is None:
        return
    for topic in msrcn.aflows:
        if rules := rules_reading(topic, msrcn):
            yield topic, rules


def _combined(evaluators: Sequence[ActionEvaluator]) -> ActionEvaluator:
    if len(evaluators) == 1:
        return evaluators[0]
    rules = tuple(rule for evaluate in evaluators for rule in evaluate.rules)

    def evaluate(message: bytes) -> Sequence[RuleResult]:
        return [judgement for each in evaluators for judgement in each.evaluate(message)]

    return ActionEvaluator(evaluators[0].md5sum, rules, evaluate)


@dataclass(frozen=True, slots=True)
class RuleChange:
    """Other rules, ready to be put in force, with their evaluators and statuses."""

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
        """Return the change to a plan's rules; nothing changes yet. InputError if it is invalid."""
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
    """Return the compiled conditions of rules by their text."""
    conditions = (rule_status.condition for rule_status in rule_statuses.values())
    return {each.text: each for each in conditions if isinstance(each, Condition)}

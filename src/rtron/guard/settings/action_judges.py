"""What judges the messages of each topic, when settings let rules look into other topics."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from rtron.guard.core.observations import ActionEvaluator, action_evaluator, rules_reading
from rtron.guard.judging import EvaluatorFactory
from rtron.policies.mission.rule_block import RuleResult
from rtron.vocabulary import MSRCN, GuardedTopic, MissionRule, Plan, normalise_type


class ActionEvaluators:
    """The judges of a plan, and one for each rule, which any topic of its type can use.

    Compiling takes milliseconds, which the messages would wait: it is done once, and beforehand
    for the type that a rule is written for.
    """

    def __init__(self, plan: Plan, planned: Mapping[str, ActionEvaluator]) -> None:
        self._planned = planned
        self._rule_evaluators: dict[tuple[str, str], ActionEvaluator] = {}
        self._plan = plan
        for topic, rules in _topics_with_rules(plan.msrcn):
            for rule in rules:
                self._rule_evaluator(topic, rule)

    def for_mission(self, msrcn: MSRCN | None) -> dict[str, ActionEvaluator]:
        """Return the judge of each topic that rules look into; InputError if one cannot be."""
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

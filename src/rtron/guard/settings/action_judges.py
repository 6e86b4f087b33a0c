"""What judges the messages of each topic, when settings let rules look into other topics."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from rtron.guard.core.observations import ActionJudge, action_judge, looking_into
from rtron.guard.judging import Judges
from rtron.policies.mission.rule_block import Judgement
from rtron.vocabulary import MSRCN, GuardedTopic, Plan, Rule, normalise_type


class ActionJudges:
    """The judges of a plan, and one for each rule, which any topic of its type can use.

    Compiling takes milliseconds, which the messages would wait: it is done once, and beforehand
    for the type that a rule is written for.
    """

    def __init__(self, plan: Plan, planned: Mapping[str, ActionJudge]) -> None:
        self._planned = planned
        self._single: dict[tuple[str, str], ActionJudge] = {}
        self._plan = plan
        for topic, rules in _looking(plan.msrcn):
            for rule in rules:
                self._of_rule(topic, rule)

    def of(self, msrcn: MSRCN | None) -> dict[str, ActionJudge]:
        """Return the judge of each topic that rules look into; InputError if one cannot be."""
        return {topic.topic: self._of_topic(topic, rules) for topic, rules in _looking(msrcn)}

    @cached_property
    def _maker(self) -> Judges:
        if self._plan.msrcn is None:
            raise AssertionError("there are no rules without an MSRCN")
        return Judges(self._plan, self._plan.msrcn)

    def _of_topic(self, topic: GuardedTopic, rules: Sequence[Rule]) -> ActionJudge:
        planned = self._planned.get(topic.topic)
        known = planned.rules if planned else ()
        more = [self._of_rule(topic, rule) for rule in rules if rule.name not in known]
        return _joined([planned, *more] if planned else more)

    def _of_rule(self, topic: GuardedTopic, rule: Rule) -> ActionJudge:
        key = (normalise_type(topic.type), rule.name)
        if key not in self._single:
            self._single[key] = action_judge(topic, [rule], self._maker)
        return self._single[key]


def _looking(msrcn: MSRCN | None) -> Iterator[tuple[GuardedTopic, list[Rule]]]:
    if msrcn is None:
        return
    for topic in msrcn.aflows:
        if rules := looking_into(topic, msrcn):
            yield topic, rules


def _joined(judges: Sequence[ActionJudge]) -> ActionJudge:
    if len(judges) == 1:
        return judges[0]
    rules = tuple(rule for judge in judges for rule in judge.rules)

    def judge(message: bytes) -> Sequence[Judgement]:
        return [found for each in judges for found in each.judge(message)]

    return ActionJudge(judges[0].md5sum, rules, judge)

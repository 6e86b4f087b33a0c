"""The rules of the mission under settings: which count, what they block, and when."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtron.guard.core.observations import Senses
from rtron.guard.settings.action_judges import ActionJudges
from rtron.messages.expressions.condition import Condition
from rtron.policies.mission.rule_status import Standing
from rtron.vocabulary import Plan, Rule


@dataclass(frozen=True, slots=True)
class RuleChange:
    """Other rules, ready to be put in force: what judges messages by them, and how they stand."""

    senses: Senses
    standings: dict[str, Standing]
    rules: tuple[tuple[Rule, Condition], ...]


class Rules:
    """Puts rules in force in the mission that all streams share."""

    def __init__(self, plan: Plan, senses: Senses) -> None:
        self._senses = senses
        self._judges = ActionJudges(plan, senses.actions)
        self._planned = _by_text(senses.mission.standings)

    def prepare(self, plan: Plan) -> RuleChange:
        """Return the rules of a plan, nothing changes yet; InputError if they cannot be."""
        judges = self._judges.of(plan.msrcn)
        known = self._planned | _by_text(self._senses.mission.standings)
        planned = plan.msrcn.rules if plan.msrcn else ()
        rules = tuple((rule, self._condition(rule.when, known)) for rule in planned)
        standings = self._senses.mission.with_rules(rules)
        return RuleChange(replace(self._senses, actions=judges), standings, rules)

    def put(self, change: RuleChange, now: int) -> None:
        """Put rules in force."""
        self._senses.mission.replace(change.standings, change.rules, now)

    def _condition(self, text: str, known: Mapping[str, Condition]) -> Condition:
        return known.get(text) or Condition(text, self._senses.mission.bits.named)


def _by_text(standings: Mapping[str, Standing]) -> dict[str, Condition]:
    """Return the conditions of rules that have been read already."""
    conditions = (standing.condition for standing in standings.values())
    return {each.text: each for each in conditions if isinstance(each, Condition)}

"""Block in an MSRCN: an aflow passes unless a block bit or a rule of the mission forbids it."""

from collections.abc import Callable, Mapping

from rtron.policies.mission.rule_status import Mission, Standing
from rtron.policies.policy import Immediate
from rtron.policies.verdicts import Answers, Gate
from rtron.vocabulary import Decision, PolicySettings, Verdict

Judgement = bool | str
"""Whether an expression holds for a message, or why that cannot be told."""
Judge = Callable[[object], Mapping[str, Judgement]]
"""Judges a message by the `action` of each rule, by the rule's name."""


class RuleBlock(Immediate):
    """The rules that concern one topic; `judge` looks into its messages where a rule asks.

    A message is looked into once, however many rules ask and however often.
    """

    __slots__ = (
        "_drop",
        "_gate",
        "_judge",
        "_judged",
        "_looked_into",
        "_mission",
        "_pass",
        "_reasons",
        "_rules",
    )

    def __init__(
        self,
        settings: PolicySettings,
        mission: Mission,
        judge: Judge,
        standings: Mapping[str, Standing] | None = None,
    ) -> None:
        """`standings` are those of the mission, or what they will be."""
        standings = mission.standings if standings is None else standings
        self._gate = Gate(settings)
        self._drop = Answers(settings, Decision.DROP)
        self._pass = Answers(settings, Decision.PASS)
        self._reasons = {name: f"no rule blocks {name}" for name in self._gate.flows}
        self._mission = mission
        self._judge = judge
        self._looked_into: object = None
        self._judged: Mapping[str, Judgement] = {}
        self._rules: dict[str, tuple[Standing, ...]] = {
            flow: tuple(standings[rule.name] for rule in settings.rules if flow in rule.blocks)
            for flow in self._gate.flows
        }

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Drop the message if a rule that holds at `now` blocks it."""
        refusal = self.refusal(flow, now, message)
        return refusal or self._pass.give(flow, self._reasons[flow])

    def refusal(self, flow: str, now: int, message: object = None) -> Verdict | None:
        """Return what a message is dropped with: a bit, or a rule that blocks."""
        if flow not in self._reasons:
            return self._gate.refusal(flow)
        self._mission.catch_up(now)
        for standing in self._rules[flow]:
            if standing.blocks and (found := self._found(standing, message)) is not False:
                return self._dropped(flow, standing, found)
        return None

    def revise(self, revision: int) -> None:
        """Say from now on that verdicts are by settings of `revision`."""
        for each in (self._gate, self._pass, self._drop):
            each.revise(revision)

    def _found(self, standing: Standing, message: object) -> Judgement:
        """Return what a rule says about a message; without one, only whether it blocks all."""
        if not standing.rule.action:
            return True
        if message is None:
            return False
        if message is not self._looked_into:
            self._looked_into, self._judged = message, self._judge(message)
        return self._judged.get(standing.rule.name, True)

    def _dropped(self, flow: str, standing: Standing, found: Judgement) -> Verdict:
        if found is True:
            return self._drop.give(flow, standing.reason)
        return self._drop.once(flow, f"{standing.reason} ({found})", error=True)

"""Block in an MSRCN: an aflow passes unless a block bit or a rule of the mission forbids it."""

from collections.abc import Callable, Mapping, Sequence

from rtron.policies.answers import Answers, Gate
from rtron.policies.mission import Mission, Standing
from rtron.policies.policy import Release
from rtron.vocabulary import Decision, PolicySettings, Verdict

Judgement = bool | str
"""Whether an expression holds for a message, or why that cannot be told."""
Judge = Callable[[object], Mapping[str, Judgement]]
"""Judges a message by the `action` of each rule, by the rule's name."""


class RuleBlock:
    """The rules that concern one topic; `judge` looks into its messages where a rule asks."""

    __slots__ = ("_drop", "_gate", "_judge", "_mission", "_passed", "_rules")

    def __init__(self, settings: PolicySettings, mission: Mission, judge: Judge) -> None:
        self._gate = Gate(settings)
        self._drop = Answers(settings, Decision.DROP)
        passed = Answers(settings, Decision.PASS)
        self._passed = {
            name: passed.once(name, f"no rule blocks {name}") for name in self._gate.flows
        }
        self._mission = mission
        self._judge = judge
        self._rules: dict[str, tuple[Standing, ...]] = {
            flow: tuple(
                mission.standings[rule.name] for rule in settings.rules if flow in rule.blocks
            )
            for flow in self._gate.flows
        }

    def verdict(self, flow: str, message: object, now: int) -> Verdict:
        """Drop the message if a rule that holds at `now` blocks it."""
        if flow not in self._passed:
            return self._gate.refusal(flow)
        self._mission.catch_up(now)
        judged: Mapping[str, Judgement] | None = None
        for standing in self._rules[flow]:
            if standing.blocks:
                if standing.rule.action and judged is None:
                    judged = self._judge(message)
                found = (judged or {}).get(standing.rule.name, True)
                if found is not False:
                    return self._dropped(flow, standing, found)
        return self._passed[flow]

    def refusal(self, flow: str, now: int) -> Verdict | None:
        """Return what each message of `flow` is dropped with: a bit, a rule without `action`."""
        if flow not in self._passed:
            return self._gate.refusal(flow)
        self._mission.catch_up(now)
        for standing in self._rules[flow]:
            if standing.blocks and not standing.rule.action:
                return self._drop.give(flow, standing.reason)
        return None

    def observe_done(self, now: int) -> None:
        """Nothing is in progress here."""

    def tick(self, now: int) -> Sequence[Release]:  # noqa: ARG002
        """Nothing is ever held."""
        return ()

    def close(self) -> Sequence[Release]:
        """Nothing is ever held."""
        return ()

    def deadline(self) -> int | None:
        """Time changes nothing here: the mission knows when it is to be asked again."""
        return None

    @property
    def owner(self) -> str | None:
        """Nobody: the flows share the output."""
        return None

    def _dropped(self, flow: str, standing: Standing, found: Judgement) -> Verdict:
        if found is True:
            return self._drop.give(flow, standing.reason)
        return self._drop.once(flow, f"{standing.reason} ({found})", error=True)

"""Rules that cannot be kept, found by trying every combination of the eflow bits.

Rules that touch a common aflow are one group and are tried together. A set of combinations is an
integer with a bit for each: what blocks under either rule is `|`, what is left over `& ~`.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import product
from operator import and_, or_
from typing import Protocol

from rtron.coherence.msrcn import flows_by_name
from rtron.planning.problem import ProblemLevel
from rtron.vocabulary import MSRCN, MissionRule

MAX_EVENTS = 12
MAX_CASES = 50_000
Contradiction = tuple[ProblemLevel, MissionRule, str]
"""How bad it is, a rule that has part in it, and what is wrong with its `when`."""


class BitCondition(Protocol):
    """What is needed of a rule's condition: its eflows, and whether it holds for their bits."""

    @property
    def names(self) -> Collection[str]: ...  # noqa: D102 - see above

    def holds(self, bits: Mapping[str, bool]) -> bool | None: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class _RuleCase:
    """A rule with its aflows: those it blocks, and those one of which must speak."""

    rule: MissionRule
    condition: BitCondition
    blocked_flows: frozenset[str]
    required_flows: frozenset[str]

    @property
    def blocks_every_message(self) -> bool:
        """Whether it blocks whatever the action says."""
        return not self.rule.action


def contradictions(msrcn: MSRCN, conditions: Mapping[str, BitCondition]) -> Iterator[Contradiction]:
    """Yield what can never work; `conditions` has the condition of each rule that is in order."""
    actions = flows_by_name(msrcn)
    cases = [
        _RuleCase(
            rule=rule,
            condition=conditions[rule.name],
            blocked_flows=frozenset[str]().union(*(actions.get(name, ()) for name in rule.block)),
            required_flows=actions.get(rule.require, frozenset()),
        )
        for rule in msrcn.rules
        if rule.name in conditions
    ]
    for group in _groups(cases):
        names = sorted({name for one in group for name in one.condition.names})
        if len(names) > MAX_EVENTS or _case_count(group) > MAX_CASES:
            yield _not_tried(group, names)
        else:
            yield from _RuleGroup(msrcn, group, names).contradictions()


def _groups(cases: Iterable[_RuleCase]) -> list[list[_RuleCase]]:
    """Part the rules so that those which touch a common aflow are together."""
    groups: list[tuple[frozenset[str], list[_RuleCase]]] = []
    for one in cases:
        touched, rules_of_group = one.blocked_flows | one.required_flows, [one]
        separate = []
        for flows, rules in groups:
            if flows & touched:
                touched, rules_of_group = touched | flows, rules + rules_of_group
            else:
                separate.append((flows, rules))
        groups = [*separate, (touched, rules_of_group)]
    return [rules for _, rules in groups]


def _case_count(group: Iterable[_RuleCase]) -> int:
    return sum(1 << len(one.condition.names) for one in group)


def _not_tried(group: Sequence[_RuleCase], names: Sequence[str]) -> Contradiction:
    whose = f"this rule and {len(group) - 1} more with the same aflows"
    message = f"{whose} depend on {len(names)} eflows: whether they contradict was not tried"
    return ProblemLevel.WARNING, group[0].rule, message


class _RuleGroup:
    """Rules that touch common aflows, with the combinations of bits for which each holds."""

    def __init__(self, msrcn: MSRCN, rules: Sequence[_RuleCase], names: Sequence[str]) -> None:
        self._msrcn = msrcn
        self._rules = rules
        self._all = (1 << (1 << len(names))) - 1
        self._holds = {one.rule.name: _combinations(one.condition, names) for one in rules}

    def contradictions(self) -> Iterator[Contradiction]:
        for one in self._rules:
            if not self._holds[one.rule.name]:
                yield ProblemLevel.ERROR, one.rule, "this can never hold"
        always = self._always_blocked()
        yield from self._redundant_rules(always)
        yield from self._blocked_together(always)
        yield from self._obligations()

    def _always_blocked(self) -> dict[str, str]:
        """Return each aflow that a rule without condition blocks, and that rule's name."""
        blockers: dict[str, str] = {}
        for one in self._blocking_rules():
            if not one.condition.names and self._holds[one.rule.name]:
                blockers |= dict.fromkeys(one.blocked_flows, one.rule.name)
        return blockers

    def _blocking_rules(self) -> Iterator[_RuleCase]:
        """Yield the rules that block for as long as they hold."""
        return (one for one in self._rules if one.blocks_every_message and not one.rule.require)

    def _redundant_rules(self, always: Mapping[str, str]) -> Iterator[Contradiction]:
        for one in self._rules:
            if one.condition.names and one.blocked_flows and one.blocked_flows <= always.keys():
                who = ", ".join(sorted({always[flow] for flow in one.blocked_flows}))
                yield (
                    ProblemLevel.WARNING,
                    one.rule,
                    f"this rule changes nothing: {who} always blocks",
                )

    def _blocked_together(self, always: Collection[str]) -> Iterator[Contradiction]:
        rules_by_flow: dict[tuple[str, ...], set[str]] = defaultdict(set)
        for flow in {flow for one in self._rules for flow in one.blocked_flows}.difference(always):
            together = self._minimal_cover(
                [one for one in self._blocking_rules() if flow in one.blocked_flows]
            )
            if together:
                rules_by_flow[together].add(flow)
        rules = {one.rule.name: one.rule for one in self._rules}
        for names, flows in sorted(rules_by_flow.items()):
            what = self._describe_flows(flows)
            message = f"with {' and '.join(names)}, nothing passes on {what}, whatever happens"
            for name in names:
                yield ProblemLevel.ERROR, rules[name], message

    def _minimal_cover(self, rules: Sequence[_RuleCase]) -> tuple[str, ...]:
        """Return the fewest of the rules that together always hold; empty if they do not."""
        remaining = [one.rule.name for one in rules]
        if _any(self._holds, remaining) != self._all:
            return ()
        for name in tuple(remaining):
            others = [other for other in remaining if other != name]
            remaining = others if _any(self._holds, others) == self._all else remaining
        return tuple(remaining)

    def _describe_flows(self, flows: Collection[str]) -> str:
        """Name aflows, all those of one topic by the topic."""
        complete_topics = [
            (topic.topic, {flow.name for flow in topic.flows})
            for topic in self._msrcn.aflows
            if topic.flows and all(flow.name in flows for flow in topic.flows)
        ]
        other_flows = set(flows).difference(*(names for _, names in complete_topics))
        return " and ".join([*(topic for topic, _ in complete_topics), *sorted(other_flows)])

    def _obligations(self) -> Iterator[Contradiction]:
        endless = self._endless_rules()
        for one in self._rules:
            holds, stuck = self._holds[one.rule.name], endless[one.rule.name]
            if not (one.required_flows and stuck):
                continue
            who = " and ".join(
                sorted(
                    {
                        s.rule.name
                        for s in self._blockers(one.required_flows)
                        if endless[s.rule.name]
                    }
                )
            )
            message = f"{one.rule.require} is required and can never speak: {who} blocks it"
            if stuck == holds:
                yield ProblemLevel.ERROR, one.rule, message
            else:
                yield ProblemLevel.WARNING, one.rule, message.replace("never", "not always")

    def _blockers(self, flows: Collection[str]) -> Iterator[_RuleCase]:
        return (
            one
            for one in self._rules
            if one.blocks_every_message and not one.blocked_flows.isdisjoint(flows)
        )

    def _endless_rules(self) -> dict[str, int]:
        """Return for which combinations each rule stays: no flow that would end it can speak.

        An obligation that can be met ends, and may free the flow that another one waits for.
        """
        stays = dict(self._holds)
        waits = {one.rule.name: self._blocker_sets(one) for one in self._rules if one.rule.require}
        before: dict[str, int] = {}
        while before != stays:
            before = dict(stays)
            for name, blocker_sets in waits.items():
                blocked = reduce(
                    and_, (_any(stays, blockers) for blockers in blocker_sets), self._all
                )
                stays[name] &= blocked if blocker_sets else 0
        return stays

    def _blocker_sets(self, one: _RuleCase) -> set[tuple[str, ...]]:
        """Return, for each flow that would end an obligation, the rules that block it."""
        return {tuple(s.rule.name for s in self._blockers([flow])) for flow in one.required_flows}


def _any(sets: Mapping[str, int], names: Iterable[str]) -> int:
    return reduce(or_, (sets[name] for name in names), 0)


def _combinations(condition: BitCondition, names: Sequence[str]) -> int:
    """Return the combinations of the bits of `names` for which a condition holds."""
    indexes = [index for index, name in enumerate(names) if name in condition.names]
    holds = {
        bits: condition.holds(dict(zip((names[index] for index in indexes), bits, strict=True)))
        for bits in product((False, True), repeat=len(indexes))
    }
    every = product((False, True), repeat=len(names))
    return int("".join("01"[holds[tuple(bits[p] for p in indexes)] is True] for bits in every), 2)

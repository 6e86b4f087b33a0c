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

from rtron.planning.coherence.msrcn import flows_by_name
from rtron.planning.problem import Level
from rtron.vocabulary import MSRCN, Rule

MOST_EVENTS = 12
MOST_CASES = 50_000
Contradiction = tuple[Level, Rule, str]
"""How bad it is, a rule that has part in it, and what is wrong with its `when`."""


class Condition(Protocol):
    """What is needed of a rule's condition: its eflows, and whether it holds for their bits."""

    @property
    def names(self) -> Collection[str]: ...  # noqa: D102 - see above

    def holds(self, bits: Mapping[str, bool]) -> bool | None: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class _Judged:
    """A rule with its aflows: those it blocks, and those one of which must speak."""

    rule: Rule
    condition: Condition
    blocks: frozenset[str]
    needs: frozenset[str]

    @property
    def plain(self) -> bool:
        """Whether it blocks whatever the action says."""
        return not self.rule.action


def contradictions(msrcn: MSRCN, conditions: Mapping[str, Condition]) -> Iterator[Contradiction]:
    """Yield what can never work; `conditions` has the condition of each rule that is in order."""
    actions = flows_by_name(msrcn)
    judged = [
        _Judged(
            rule=rule,
            condition=conditions[rule.name],
            blocks=frozenset[str]().union(*(actions.get(name, ()) for name in rule.block)),
            needs=actions.get(rule.require, frozenset()),
        )
        for rule in msrcn.rules
        if rule.name in conditions
    ]
    for group in _groups(judged):
        names = sorted({name for one in group for name in one.condition.names})
        if len(names) > MOST_EVENTS or _cases(group) > MOST_CASES:
            yield _not_tried(group, names)
        else:
            yield from _Group(msrcn, group, names).contradictions()


def _groups(judged: Iterable[_Judged]) -> list[list[_Judged]]:
    """Part the rules so that those which touch a common aflow are together."""
    groups: list[tuple[frozenset[str], list[_Judged]]] = []
    for one in judged:
        touched, own = one.blocks | one.needs, [one]
        apart = []
        for flows, rules in groups:
            if flows & touched:
                touched, own = touched | flows, rules + own
            else:
                apart.append((flows, rules))
        groups = [*apart, (touched, own)]
    return [rules for _, rules in groups]


def _cases(group: Iterable[_Judged]) -> int:
    return sum(1 << len(one.condition.names) for one in group)


def _not_tried(group: Sequence[_Judged], names: Sequence[str]) -> Contradiction:
    whose = f"this rule and {len(group) - 1} more with the same aflows"
    told = f"{whose} depend on {len(names)} eflows: whether they contradict was not tried"
    return Level.WARNING, group[0].rule, told


class _Group:
    """Rules that touch common aflows, with the combinations of bits for which each holds."""

    def __init__(self, msrcn: MSRCN, rules: Sequence[_Judged], names: Sequence[str]) -> None:
        self._msrcn = msrcn
        self._rules = rules
        self._all = (1 << (1 << len(names))) - 1
        self._holds = {one.rule.name: _combinations(one.condition, names) for one in rules}

    def contradictions(self) -> Iterator[Contradiction]:
        for one in self._rules:
            if not self._holds[one.rule.name]:
                yield Level.ERROR, one.rule, "this can never hold"
        always = self._always_blocked()
        yield from self._idle(always)
        yield from self._blocked_together(always)
        yield from self._obligations()

    def _always_blocked(self) -> dict[str, str]:
        """Return each aflow that a rule without condition blocks, and that rule's name."""
        found: dict[str, str] = {}
        for one in self._stoppers():
            if not one.condition.names and self._holds[one.rule.name]:
                found |= dict.fromkeys(one.blocks, one.rule.name)
        return found

    def _stoppers(self) -> Iterator[_Judged]:
        """Yield the rules that block for as long as they hold."""
        return (one for one in self._rules if one.plain and not one.rule.require)

    def _idle(self, always: Mapping[str, str]) -> Iterator[Contradiction]:
        for one in self._rules:
            if one.condition.names and one.blocks and one.blocks <= always.keys():
                who = ", ".join(sorted({always[flow] for flow in one.blocks}))
                yield Level.WARNING, one.rule, f"this rule changes nothing: {who} always blocks"

    def _blocked_together(self, always: Collection[str]) -> Iterator[Contradiction]:
        found: dict[tuple[str, ...], set[str]] = defaultdict(set)
        for flow in {flow for one in self._rules for flow in one.blocks}.difference(always):
            together = self._needed([one for one in self._stoppers() if flow in one.blocks])
            if together:
                found[together].add(flow)
        rules = {one.rule.name: one.rule for one in self._rules}
        for names, flows in sorted(found.items()):
            what = self._said(flows)
            told = f"with {' and '.join(names)}, nothing passes on {what}, whatever happens"
            for name in names:
                yield Level.ERROR, rules[name], told

    def _needed(self, rules: Sequence[_Judged]) -> tuple[str, ...]:
        """Return the fewest of the rules that together always hold; empty if they do not."""
        left = [one.rule.name for one in rules]
        if _any(self._holds, left) != self._all:
            return ()
        for name in tuple(left):
            others = [other for other in left if other != name]
            left = others if _any(self._holds, others) == self._all else left
        return tuple(left)

    def _said(self, flows: Collection[str]) -> str:
        """Name aflows, all those of one topic by the topic."""
        whole = [
            (topic.topic, {flow.name for flow in topic.flows})
            for topic in self._msrcn.aflows
            if topic.flows and all(flow.name in flows for flow in topic.flows)
        ]
        single = set(flows).difference(*(names for _, names in whole))
        return " and ".join([*(topic for topic, _ in whole), *sorted(single)])

    def _obligations(self) -> Iterator[Contradiction]:
        open_ends = self._never_ending()
        for one in self._rules:
            holds, stuck = self._holds[one.rule.name], open_ends[one.rule.name]
            if not (one.needs and stuck):
                continue
            who = " and ".join(
                sorted({s.rule.name for s in self._blockers(one.needs) if open_ends[s.rule.name]})
            )
            told = f"{one.rule.require} is required and can never speak: {who} blocks it"
            if stuck == holds:
                yield Level.ERROR, one.rule, told
            else:
                yield Level.WARNING, one.rule, told.replace("never", "not always")

    def _blockers(self, flows: Collection[str]) -> Iterator[_Judged]:
        return (one for one in self._rules if one.plain and not one.blocks.isdisjoint(flows))

    def _never_ending(self) -> dict[str, int]:
        """Return for which combinations each rule stays: no flow that would end it can speak.

        An obligation that can be met ends, and may free the flow that another one waits for.
        """
        stays = dict(self._holds)
        waits = {one.rule.name: self._ends(one) for one in self._rules if one.rule.require}
        before: dict[str, int] = {}
        while before != stays:
            before = dict(stays)
            for name, ends in waits.items():
                blocked = reduce(and_, (_any(stays, end) for end in ends), self._all)
                stays[name] &= blocked if ends else 0
        return stays

    def _ends(self, one: _Judged) -> set[tuple[str, ...]]:
        """Return, for each flow that would end an obligation, the rules that block it."""
        return {tuple(s.rule.name for s in self._blockers([flow])) for flow in one.needs}


def _any(sets: Mapping[str, int], names: Iterable[str]) -> int:
    return reduce(or_, (sets[name] for name in names), 0)


def _combinations(condition: Condition, names: Sequence[str]) -> int:
    """Return the combinations of the bits of `names` for which a condition holds."""
    own = [place for place, name in enumerate(names) if name in condition.names]
    holds = {
        bits: condition.holds(dict(zip((names[place] for place in own), bits, strict=True)))
        for bits in product((False, True), repeat=len(own))
    }
    every = product((False, True), repeat=len(names))
    return int("".join("01"[holds[tuple(bits[p] for p in own)] is True] for bits in every), 2)

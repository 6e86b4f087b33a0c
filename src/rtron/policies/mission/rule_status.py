"""The rules of a mission (MSRCN): which of them hold at a moment, and which obligations are met.

A rule whose condition nobody can tell, because an event that it asks for is silent, counts as
holding. The most restrictive rule wins: what one rule blocks, no other releases.
"""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

from rtron.policies.mission.event_bits import Bits, Truth
from rtron.vocabulary import Rule


class Condition(Protocol):
    """A rule's `when`: a boolean combination of bits."""

    @property
    def names(self) -> Collection[str]:
        """The eflows whose bits it asks for."""
        ...

    def holds(self, bits: Mapping[str, bool]) -> Truth:
        """Return whether it holds with the bits that are known; None if they do not decide it."""
        ...


@dataclass(slots=True, eq=False)
class Standing:
    """A rule, and how it stands: whether it holds, and whether what it requires is still owed.

    It is owed from the moment at which the rule is known to hold until it is seen, also when the
    rule holds no longer; what was seen before that moment does not count.
    """

    rule: Rule
    condition: Condition
    holds: bool = False
    unknown: tuple[str, ...] = ()
    met: bool = False
    owed: bool = False

    @property
    def blocks(self) -> bool:
        """Whether the rule blocks anything now."""
        return self.owed or (self.holds and not self.met)

    @property
    def reason(self) -> str:
        """Why it blocks."""
        told = self.rule.reason or f"while {self.rule.when}"
        unknown = f" (not known: {', '.join(self.unknown)})" if self.unknown else ""
        return f"rule {self.rule.name}: {told}{unknown}"

    def update(self, known: Mapping[str, bool]) -> bool:
        """Take the bits that are known; tell whether the rule began or ceased to block."""
        before = self.blocks
        truth = self.condition.holds(known)
        begins = truth is True and (not self.holds or bool(self.unknown))
        self.unknown = () if truth is not None else self._missing(known)
        self.holds = truth is not False
        self.met = self.met and self.holds and not begins
        self.owed = self.owed or (begins and bool(self.rule.require))
        return self.blocks is not before

    def change(self, rule: Rule, condition: Condition, known: Mapping[str, bool]) -> bool:
        """Take the place of the rule of this name; tell whether it began or ceased to block.

        What is owed stays owed as long as the same is required. A condition that is another one
        is looked at as if it had never held.
        """
        before = self.blocks
        if rule.when != self.rule.when:
            self.holds, self.met, self.unknown = False, False, ()
        self.owed = self.owed and rule.require == self.rule.require
        self.rule, self.condition = rule, condition
        self.update(known)
        return self.blocks is not before

    def end(self) -> bool:
        """Block nothing any more; tell whether it did."""
        before = self.blocks
        self.holds = self.owed = False
        return before

    def meet(self) -> bool:
        """Note that what the rule requires was seen; tell whether that ends its block."""
        ends = self.blocks
        self.met = self.met or self.holds
        self.owed = False
        return ends

    def _missing(self, known: Mapping[str, bool]) -> tuple[str, ...]:
        return tuple(sorted(set(self.condition.names).difference(known)))


class Mission:
    """All rules of an app, kept up to date with the bits of its events.

    `changed` is told each rule that begins or ceases to block. `due` is when to look again if
    nothing is heard; the first look is due at once, since some bits are known without a message.
    """

    def __init__(self, bits: Bits, rules: Iterable[tuple[Rule, Condition]] = ()) -> None:
        self.bits = bits
        self.standings = {rule.name: Standing(rule, condition) for rule, condition in rules}
        self.changed: Callable[[Standing], None] = lambda standing: None
        self.due: int | None = 0
        self._known: dict[str, bool] = {}
        for standing in self.standings.values():
            standing.update(self._known)
        self._index()

    def with_rules(self, rules: Iterable[tuple[Rule, Condition]]) -> dict[str, Standing]:
        """Return what `standings` will be with other rules; nothing changes yet.

        A rule that is called as one before will be the standing of this one.
        """
        made = (Standing(rule, condition) for rule, condition in rules)
        return {new.rule.name: self.standings.get(new.rule.name, new) for new in made}

    def replace(
        self,
        standings: dict[str, Standing],
        rules: Iterable[tuple[Rule, Condition]],
        now: int,
    ) -> None:
        """Put other rules in force, with the standings that `with_rules` has made for them.

        The bits stay, unchanged rules stand as they did, and what is gone blocks nothing any more.
        """
        self.catch_up(now)
        before, self.standings = self.standings, standings
        gone = [each for name, each in before.items() if name not in standings]
        changed = [each for each in gone if each.end()]
        for rule, condition in rules:
            standing = standings[rule.name]
            if rule.name not in before:
                begins = standing.update(self._known)
            else:
                begins = rule != standing.rule and standing.change(rule, condition, self._known)
            changed += [standing] if begins else []
        self._index()
        self._tell(changed)

    def observe(self, flow: str, judged: Truth, now: int) -> None:
        """Take an event of an eflow, and what it says; it may be what a rule requires."""
        bit = self.bits.named[flow]
        bit.observe(judged, now)
        if judged:
            self.meet((*self._requiring.get(flow, ()), *self._requiring.get(bit.flow.topic, ())))

    def update(self, now: int) -> None:
        """Look at the bits again: an event was heard, or time has passed."""
        self.due = self.bits.deadline(now)
        known, before = self.bits.known(now), self._known
        if known == before:
            return
        self._known = known
        changed = (name for name in known.keys() | before.keys() if _differ(name, known, before))
        asking = dict.fromkeys(each for name in changed for each in self._asking[name])
        self._tell([standing for standing in asking if standing.update(known)])

    def catch_up(self, now: int) -> None:
        """Look at the bits again if one has changed by time alone."""
        if self.due is not None and now >= self.due:
            self.update(now)

    def meet(self, rules: Iterable[str]) -> None:
        """Note that what these rules require was seen."""
        self._tell([each for name in rules if (each := self.standings[name]).meet()])

    def _index(self) -> None:
        """Know which rules ask for which bit, and which require what."""
        self._asking: dict[str, list[Standing]] = defaultdict(list)
        self._requiring: dict[str, list[str]] = defaultdict(list)
        for standing in self.standings.values():
            self._requiring[standing.rule.require].append(standing.rule.name)
            for name in standing.condition.names:
                self._asking[name].append(standing)

    def _tell(self, changed: Iterable[Standing]) -> None:
        for standing in changed:
            self.changed(standing)


def _differ(name: str, one: Mapping[str, bool], other: Mapping[str, bool]) -> bool:
    return one.get(name) is not other.get(name)

"""The rules of a mission (MSRCN): which of them hold at a moment, and which obligations are met.

A rule whose condition nobody can tell, because an event that it asks for is silent, counts as
holding. The most restrictive rule wins: what one rule blocks, no other releases.
"""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

from rtron.policies.mission.event_bits import EventBits, EventState, Truth
from rtron.vocabulary import MissionRule


class RuleCondition(Protocol):
    """A rule's `when`: a boolean combination of bits."""

    @property
    def names(self) -> Collection[str]:
        """The eflows whose bits it asks for."""

    def holds(self, bits: Mapping[str, bool]) -> Truth:
        """Return whether it holds with the bits that are known; None if they do not decide it."""


@dataclass(slots=True, eq=False)
class RuleStatus:
    """A rule, and how it stands: whether it holds, and whether what it requires is still owed.

    It is owed from the moment at which the rule is known to hold until it is seen, also when the
    rule holds no longer; what was seen before that moment does not count.
    """

    rule: MissionRule
    condition: RuleCondition
    holds: bool = False
    unknown_events: tuple[str, ...] = ()
    is_met: bool = False
    is_pending: bool = False

    @property
    def is_blocking(self) -> bool:
        """Whether the rule blocks anything now."""
        return self.is_pending or (self.holds and not self.is_met)

    @property
    def reason(self) -> str:
        """Why it blocks."""
        reason = self.rule.reason or f"while {self.rule.when}"
        unknown = f" (not known: {', '.join(self.unknown_events)})" if self.unknown_events else ""
        return f"rule {self.rule.name}: {reason}{unknown}"

    def update(self, known: Mapping[str, bool]) -> bool:
        """Take the bits that are known; tell whether the rule began or ceased to block."""
        before = self.is_blocking
        truth = self.condition.holds(known)
        begins = truth is True and (not self.holds or bool(self.unknown_events))
        self.unknown_events = () if truth is not None else self._unknown_names(known)
        self.holds = truth is not False
        self.is_met = self.is_met and self.holds and not begins
        self.is_pending = self.is_pending or (begins and bool(self.rule.require))
        return self.is_blocking is not before

    def replace_rule(
        self, rule: MissionRule, condition: RuleCondition, known: Mapping[str, bool]
    ) -> bool:
        """Take the place of the rule of this name; tell whether it began or ceased to block.

        What is owed stays owed as long as the same is required. A condition that is another one
        is looked at as if it had never held.
        """
        before = self.is_blocking
        if rule.when != self.rule.when:
            self.holds, self.is_met, self.unknown_events = False, False, ()
        self.is_pending = self.is_pending and rule.require == self.rule.require
        self.rule, self.condition = rule, condition
        self.update(known)
        return self.is_blocking is not before

    def deactivate(self) -> bool:
        """Block nothing any more; tell whether it did."""
        before = self.is_blocking
        self.holds = self.is_pending = False
        return before

    def mark_met(self) -> bool:
        """Note that what the rule requires was seen; tell whether that ends its block."""
        was_blocking = self.is_blocking
        self.is_met = self.is_met or self.holds
        self.is_pending = False
        return was_blocking

    def _unknown_names(self, known: Mapping[str, bool]) -> tuple[str, ...]:
        return tuple(sorted(set(self.condition.names).difference(known)))


class MissionMonitor:
    """All rules of an app, kept up to date with the bits of its events.

    `on_change` is told each rule that begins or ceases to block. `due` is when to look again if
    nothing is heard; the first look is due at once, since some bits are known without a message.
    """

    def __init__(
        self, bits: EventBits, rules: Iterable[tuple[MissionRule, RuleCondition]] = ()
    ) -> None:
        self.bits = bits
        self.statuses = {rule.name: RuleStatus(rule, condition) for rule, condition in rules}
        self.on_change: Callable[[RuleStatus], None] = lambda status: None
        self.due: int | None = 0
        self._known: dict[str, bool] = {}
        for status in self.statuses.values():
            status.update(self._known)
        self._build_index()

    def prepare_rules(
        self, rules: Iterable[tuple[MissionRule, RuleCondition]]
    ) -> dict[str, RuleStatus]:
        """Return what `statuses` will be with other rules; nothing changes yet.

        A rule that is called as one before will be the standing of this one.
        """
        statuses = (RuleStatus(rule, condition) for rule, condition in rules)
        return {new.rule.name: self.statuses.get(new.rule.name, new) for new in statuses}

    def replace_rules(
        self,
        statuses: dict[str, RuleStatus],
        rules: Iterable[tuple[MissionRule, RuleCondition]],
        now: int,
    ) -> None:
        """Put other rules in force, with the standings that `prepare_rules` has made for them.

        The bits stay, unchanged rules stand as they did, and what is gone blocks nothing any more.
        """
        self.update_if_due(now)
        before, self.statuses = self.statuses, statuses
        removed = [each for name, each in before.items() if name not in statuses]
        changed = [each for each in removed if each.deactivate()]
        for rule, condition in rules:
            status = statuses[rule.name]
            if rule.name not in before:
                has_changed = status.update(self._known)
            else:
                has_changed = rule != status.rule and status.replace_rule(
                    rule, condition, self._known
                )
            changed += [status] if has_changed else []
        self._build_index()
        self._notify(changed)

    def observe(self, flow: str, judged: Truth, now: int) -> None:
        """Take an event of an eflow, and what it says; it may be what a rule requires."""
        bit = self.bits.by_name[flow]
        bit.observe(judged, now)
        if judged:
            self._mark_required(flow, bit.flow.topic)

    def restore(self, flow: str, state: EventState) -> None:
        """Take what another process has heard of an eflow; `update` looks at the bits."""
        bit = self.bits.by_name[flow]
        if bit.restore(state):
            self._mark_required(flow, bit.flow.topic)

    def update(self, now: int) -> None:
        """Look at the bits again: an event was heard, or time has passed."""
        self.due = self.bits.deadline(now)
        known, before = self.bits.known_values(now), self._known
        if known == before:
            return
        self._known = known
        changed = (name for name in known.keys() | before.keys() if _differ(name, known, before))
        affected = dict.fromkeys(each for name in changed for each in self._by_event[name])
        self._notify([status for status in affected if status.update(known)])

    def update_if_due(self, now: int) -> None:
        """Look at the bits again if one has changed by time alone."""
        if self.due is not None and now >= self.due:
            self.update(now)

    def mark_met(self, rules: Iterable[str]) -> None:
        """Note that what these rules require was seen."""
        self._notify([each for name in rules if (each := self.statuses[name]).mark_met()])

    def _mark_required(self, *names: str) -> None:
        """Note that a flow or topic was heard, which rules may require."""
        self.mark_met(rule for name in names for rule in self._by_requirement.get(name, ()))

    def _build_index(self) -> None:
        """Know which rules ask for which bit, and which require what."""
        self._by_event: dict[str, list[RuleStatus]] = defaultdict(list)
        self._by_requirement: dict[str, list[str]] = defaultdict(list)
        for status in self.statuses.values():
            self._by_requirement[status.rule.require].append(status.rule.name)
            for name in status.condition.names:
                self._by_event[name].append(status)

    def _notify(self, changed: Iterable[RuleStatus]) -> None:
        for status in changed:
            self.on_change(status)


def _differ(name: str, one: Mapping[str, bool], other: Mapping[str, bool]) -> bool:
    return one.get(name) is not other.get(name)

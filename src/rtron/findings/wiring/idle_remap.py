"""A remap changes nothing.

## What it finds

A remap whose old name no node that gets it uses. Remaps compare whole names: one of `camera/left`
does not change `camera/left/image_raw`. At the default level are those that leave a topic without
its other end: the two names are exchanged, or the old one is misspelled.

For example, `<remap from="/roof_lidar" to="/points"/>`: `/localizer` subscribes `/points`, which
nobody publishes, and `/scanner` publishes `/roof_lidar`.

## What to do

Write the name that the node uses first and the new one second, or move the remap before the node.

## When it is silent

Where a node that gets the remap has plugins or was not read whole. Idle remaps that harm nothing
are `pedantic`.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.near_names import is_near
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Direction, Finding, WiringFact, WiringFactKind
from rtron.vocabulary.names import TRANSFORM_TOPICS
from rtron.wording import conjugate, join_names

_MOST_USERS = 3
_MOST_COMPARED = 200
_VERBS = {Direction.PUBLISH: "publish", Direction.SUBSCRIBE: "subscribe"}


class _Joined(NamedTuple):
    """A topic that a node uses without another end, and the one that its remap should lead to."""

    used: str
    meant: str
    direction: Direction


@dataclass(frozen=True, slots=True)
class _UnmatchedTopics:
    """The topics that nodes use in one direction, and that certainly lack another end."""

    app: AppFacts
    _known: dict[tuple[tuple[str, ...], Direction], list[str]] = field(default_factory=dict)

    def __call__(self, nodes: tuple[str, ...], direction: Direction) -> list[str]:
        """Return the topics of nodes; none where they are so many that a pair tells nothing."""
        if (nodes, direction) not in self._known:
            found = sorted(self._of(nodes, direction))
            self._known[nodes, direction] = found if len(found) <= _MOST_COMPARED else []
        return self._known[nodes, direction]

    def _of(self, nodes: tuple[str, ...], direction: Direction) -> set[str]:
        app, other = self.app, direction.opposite
        is_published = direction is Direction.PUBLISH
        endpoints_of = app.graph.published_by if is_published else app.graph.subscribed_by
        return {
            end.topic
            for end in chain.from_iterable(map(endpoints_of, nodes))
            if not (end.implicit or "{" in end.topic or app.endpoints(end.topic, other))
            and not app.may_have_other_end(end.topic, other)
        }


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each remap without effect.

    Launch files often remap transforms for every node, be it one that uses them or not.
    """
    joined, nodes, unmatched = (
        dict[str, Finding](),
        dict[str, tuple[str, ...]](),
        _UnmatchedTopics(app),
    )
    for fact in app.graph.wiring:
        if fact.kind is WiringFactKind.UNUSED_REMAP and fact.subject not in TRANSFORM_TOPICS:
            nodes[fact.subject] = (*nodes.get(fact.subject, ()), *fact.others)
            for pair in (*_reversed(unmatched, fact), *_misnamed(unmatched, fact))[:1]:
                joined.setdefault(fact.subject, _joined_finding(app, fact, pair))
    yield from joined.values()
    for group in wiring_groups(app.graph, WiringFactKind.IDLE_REMAP):
        if group.subject not in (*TRANSFORM_TOPICS, *joined):
            yield _finding(group, _near(unmatched, group, nodes.get(group.subject, ())))


def _near(unmatched: _UnmatchedTopics, group: WiringGroup, nodes: tuple[str, ...]) -> list[str]:
    """Return the near names without another end of nodes that were read whole."""
    found = (unmatched(nodes, direction) for direction in Direction if not group.others)
    near = {topic for topics in found for topic in topics if is_near(group.subject, topic)}
    return sorted(near.difference(group.values))


def _reversed(unmatched: _UnmatchedTopics, fact: WiringFact) -> Iterator[_Joined]:
    """Yield the pair of a remap whose ends are exchanged."""
    for direction in Direction:
        is_used = fact.value in unmatched(fact.others, direction)
        if is_used and _fit(unmatched.app, fact.value, fact.subject, direction):
            yield _Joined(fact.value, fact.subject, direction)


def _misnamed(unmatched: _UnmatchedTopics, fact: WiringFact) -> Iterator[_Joined]:
    """Yield the pair of a remap whose old name is not the one that the node uses."""
    for direction in Direction:
        topics = unmatched(fact.others, direction)
        fitting = [each for each in topics if _fit(unmatched.app, each, fact.value, direction)]
        near = [topic for topic in fitting if _means(fact.subject, topic)]
        if len(near or fitting) == 1:
            yield _Joined((near or fitting)[0], fact.value, direction)


def _means(written: str, used: str) -> bool:
    return used.endswith(written) or is_near(written, used)


def _fit(app: AppFacts, used: str, meant: str, direction: Direction) -> bool:
    """Return whether a topic of other nodes lacks an end as one that is used, of its type."""
    other = direction.opposite
    if app.endpoints(meant, direction) or not app.users(meant, other):
        return False
    types = app.types(used, direction).keys() & app.types(meant, other).keys()
    return bool(types) and not app.may_have_other_end(meant, direction)


def _joined_finding(app: AppFacts, fact: WiringFact, pair: _Joined) -> Finding:
    other = pair.direction.opposite
    verb, other_verb = (conjugate((), _VERBS[each]) for each in (pair.direction, other))
    of_used = [node for node in app.users(pair.used, pair.direction) if node in fact.others]
    of_meant = app.users(pair.meant, other)
    is_reversed = pair.meant == fact.subject
    return fact_finding(
        RULE.name,
        fact,
        summary=f"the remap of {fact.subject} to {fact.value} changes nothing: "
        f"{join_names(of_used)} {conjugate(of_used, _VERBS[pair.direction])} {pair.used}, "
        f"which nobody {other_verb}",
        cause=f"{join_names(of_meant)} {conjugate(of_meant, _VERBS[other])} {pair.meant}, "
        f"which nobody {verb}; no node that gets the remap uses its old name",
        remedy="exchange its ends" if is_reversed else f"remap {pair.used} instead",
        nodes=(*of_used, *of_meant),
        topics=(fact.subject, fact.value, pair.used),
    )


def _finding(group: WiringGroup, near: list[str]) -> Finding:
    users = group.others[:_MOST_USERS]
    others = f"{join_names(users)} {conjugate(users, 'use')} it or one below it"
    remedy = "write the whole name that the node uses, or remove the remap"
    return fact_finding(
        RULE.name,
        group,
        summary=f"the remap of {group.subject} to {join_names(group.values)} changes nothing",
        cause="no node that gets it uses the name; "
        + (others if users else "their source was read whole"),
        remedy=f"did you mean {near[0]}? Else remove the remap" if near else remedy,
        certainty=Certainty.LIKELY if near else Certainty.POSSIBLE,
        topics=(group.subject, *group.values, *near[:1]),
    )


RULE = FindingRule(
    name="idle_remap",
    title="A remap changes nothing",
    consequence="failure: likely where it leaves a topic without its other end, else possible",
    since="0.1.0",
    check=check,
)

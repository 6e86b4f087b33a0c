"""What every rule is: a name, what it needs, and one pure function from facts to risks."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rtron.risks.graph_facts import Facts
from rtron.vocabulary import Risk, RiskKind, Word


class Need(Word):
    """What a graph must hold for a rule to run; without it the rule says so, never «clean»."""

    PUBLISHERS = "publishers"
    SUBSCRIBERS = "subscribers"
    TYPES = "message types"


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """One way to find risks; its module's docstring is its page, and its name the file's.

    `severity` says in words where the severity comes from, `since` the version it came with.
    """

    name: str
    kind: RiskKind
    title: str
    severity: str
    needs: tuple[Need, ...]
    since: str
    check: Callable[[Facts], Iterator[Risk]]


def missing(rule: Rule, facts: Facts) -> str:
    """Return why a rule cannot run on a graph, or an empty text."""
    lacks = [str(need) for need in rule.needs if not _HOLDS[need](facts)]
    return f"the graph holds no {' and no '.join(lacks)}" if lacks else ""


def _has_types(facts: Facts) -> bool:
    graph = facts.graph
    return any(e.type for e in graph.endpoints) or any(topic.types for topic in graph.topics)


_HOLDS: dict[Need, Callable[[Facts], bool]] = {
    Need.PUBLISHERS: lambda facts: bool(facts.published),
    Need.SUBSCRIBERS: lambda facts: bool(facts.subscribing),
    Need.TYPES: _has_types,
}

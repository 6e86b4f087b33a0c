"""What every rule is: a name, what it needs, and one pure function from facts to risks."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module

from rtron.errors import InputError, suggestion
from rtron.risks.graph_facts import GraphFacts
from rtron.vocabulary import Risk, RiskKind, StringEnum


class RuleInput(StringEnum):
    """What a graph must hold for a rule to run; without it the rule says so, never «clean»."""

    PUBLISHERS = "publishers"
    SUBSCRIBERS = "subscribers"
    TYPES = "message types"


@dataclass(frozen=True, slots=True, kw_only=True)
class RiskRule:
    """One way to find risks; its module's docstring is its page, and its name the file's.

    `severity` says in words where the severity comes from, `since` the version it came with.
    """

    name: str
    kind: RiskKind
    title: str
    severity: str
    needs: tuple[RuleInput, ...]
    since: str
    check: Callable[[GraphFacts], Iterator[Risk]]


def missing_inputs(rule: RiskRule, facts: GraphFacts) -> str:
    """Return why a rule cannot run on a graph, or an empty text."""
    lacks = [str(need) for need in rule.needs if not _IS_PRESENT[need](facts)]
    return f"the graph holds no {' and no '.join(lacks)}" if lacks else ""


def _has_types(facts: GraphFacts) -> bool:
    graph = facts.graph
    return any(e.type for e in graph.endpoints) or any(topic.types for topic in graph.topics)


_IS_PRESENT: dict[RuleInput, Callable[[GraphFacts], bool]] = {
    RuleInput.PUBLISHERS: lambda facts: bool(facts.published_topics),
    RuleInput.SUBSCRIBERS: lambda facts: bool(facts.subscribing_nodes),
    RuleInput.TYPES: _has_types,
}


def format_rule_page(rule: RiskRule) -> str:
    """Return a rule's page in Markdown: its title, its facts and its module's docstring."""
    docstring = import_module(rule.check.__module__).__doc__ or ""
    summary, text = docstring.strip().split("\n", 1)
    needs = ", ".join(map(str, rule.needs))
    return (
        f"# {rule.title}\n\n{summary}\n\n"
        f"| rule | kind | severity | needs | since |\n|---|---|---|---|---|\n"
        f"| `{rule.name}` | {rule.kind} | {rule.severity} | {needs} | {rule.since} |\n"
        f"{text}\n"
    )


def find_rule(rules: Sequence[RiskRule], name: str) -> RiskRule:
    """Return the rule of that name (`gr_st` or `GR-ST`); raise InputError if there is none."""
    known = {rule.name: rule for rule in rules}
    rule_name = name.lower().replace("-", "_")
    if rule_name in known:
        return known[rule_name]
    raise InputError(f"no rule is named {name[:80]!r}", help=suggestion(rule_name, known))

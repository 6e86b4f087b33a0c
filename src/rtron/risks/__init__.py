"""Risk discovery (paper section 6.2, Algorithm 1): one file a rule, and this registry of them."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from rtron.risks import gr_mt, gr_st, msr_action, msr_event, rsr_image, rsr_max_vel
from rtron.risks.counting import count_coordination_nodes
from rtron.risks.graph_facts import GraphFacts
from rtron.risks.lists import RiskLists, default_lists, load_lists
from rtron.risks.rule import RiskRule, find_rule, format_rule_page, missing_inputs
from rtron.vocabulary import InteractionGraph, Risk, RiskReport

__all__ = [
    "RULES",
    "RiskLists",
    "RiskRule",
    "default_lists",
    "discover_risks",
    "load_lists",
    "rule_page",
]

RULES: tuple[RiskRule, ...] = (
    gr_st.RULE,
    gr_mt.RULE,
    rsr_image.RULE,
    rsr_max_vel.RULE,
    msr_event.RULE,
    msr_action.RULE,
)


def discover_risks(graph: InteractionGraph, lists: RiskLists | None = None) -> RiskReport:
    """Return every risk in a graph, in the order of the rules, found with the default lists.

    Takes time in proportion to the endpoints. A rule whose needs the graph does not meet stands
    in `not_run` with the reason.
    """
    facts = GraphFacts(graph, lists or default_lists())
    with _without_collection():
        not_run = {rule.name: why for rule in RULES if (why := missing_inputs(rule, facts))}
        risks = [risk for rule in RULES if rule.name not in not_run for risk in rule.check(facts)]
        return _report(facts, tuple(risks), not_run)


def rule_page(name: str) -> str:
    """Return the page of a rule; raise InputError naming the nearest if there is no such rule."""
    return format_rule_page(find_rule(RULES, name))


@contextmanager
def _without_collection() -> Iterator[None]:
    """Keep the garbage collector from walking a large graph again and again: nothing is garbage."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _report(facts: GraphFacts, risks: tuple[Risk, ...], not_run: dict[str, str]) -> RiskReport:
    topics = sorted({topic for risk in risks for topic in risk.topics})
    classes = {topic: facts.classify(topic) for topic in topics}
    return RiskReport(
        app=facts.graph.app,
        risks=risks,
        coordination_nodes=count_coordination_nodes(risks, classes),
        not_run=not_run,
        topic_classes=classes,
        viewers=tuple(sorted(facts.viewers)),
    )

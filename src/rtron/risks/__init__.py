"""Risk discovery (paper section 6.2, Algorithm 1): one file a rule, and this registry of them."""

import gc
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

from rtron.risks import gr_mt, gr_st, msr_action, msr_event, rsr_image, rsr_max_vel
from rtron.risks.graph_facts import GraphFacts
from rtron.risks.lists import RiskLists, default_lists, load_lists
from rtron.risks.rule import RiskRule, find_rule, format_rule_page, missing_inputs
from rtron.vocabulary import (
    CoordinationCount,
    Domain,
    InteractionGraph,
    Risk,
    RiskKind,
    RiskReport,
    RiskRole,
    TopicClass,
)

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
_ALWAYS_SHOWN = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
_GENERAL = (RiskKind.GR_ST, RiskKind.GR_MT)


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
        coordination_nodes=_count_coordination_nodes(risks, classes),
        not_run=not_run,
        topic_classes=classes,
        viewers=tuple(sorted(facts.viewers)),
    )


def _count_coordination_nodes(
    risks: Iterable[Risk], classes: Mapping[str, TopicClass]
) -> CoordinationCount:
    """Count the nodes that risks ask for (paper section 7.2, table of CNs).

    A GRCN for each topic of a general risk, and an fps_monitor for each image node.
    One RSRCN and one MSRCN serve a whole app. Drivers and Others stand in the count only if they
    have a GRCN; the paper's table has no such column.
    """
    all_risks = tuple(risks)
    topics = {topic for risk in all_risks if risk.kind in _GENERAL for topic in risk.topics}
    domains = Counter(classes[topic].domain for topic in topics)
    kinds = {risk.kind for risk in all_risks}
    return CoordinationCount(
        grcn={d: domains[d] for d in Domain if domains[d] or d in _ALWAYS_SHOWN},
        fps_monitor=len({n for risk in all_risks for n in risk.role_nodes.get(RiskRole.IMAGE, ())}),
        rsrcn=int(RiskKind.RSR in kinds),
        msrcn=int(RiskKind.MSR in kinds),
    )

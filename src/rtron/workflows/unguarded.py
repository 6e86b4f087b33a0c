"""Why a plan that guards nothing leaves out what could move the robot."""

from collections.abc import Iterable, Iterator, Sequence

from rtron.findings.app_facts import AppFacts
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.planning.proposal.policy_defaults import unguardable_topics
from rtron.risks import default_lists
from rtron.risks.graph_facts import GraphFacts
from rtron.vocabulary import GRCN, Domain, GuardedTopic, Plan
from rtron.workflows.scan import ScanResult

_MOVING = (Domain.PLANNING, Domain.CONTROL)


def unguarded_topics(plan: Plan, scan: ScanResult | None = None) -> tuple[PlanProblem, ...]:
    """Return a warning for each topic that could move the robot, of a plan that guards nothing.

    The `scan` adds the topics of the app that the plan does not have.
    """
    problems = {each.location: each for each in (*_planned(plan), *_of_app(scan))}
    omitted = unguardable_topics(scan.graph, scan.report) if scan else ()
    problems |= {each.location: each for each in omitted}
    return tuple(problems[location] for location in sorted(problems))


def _planned(plan: Plan) -> Iterator[PlanProblem]:
    parts: Iterable[GRCN | GuardedTopic] = (
        *(grcn for grcn in plan.grcn if grcn.domain in _MOVING),
        *(plan.rsrcn.vflows if plan.rsrcn else ()),
        *(plan.msrcn.aflows if plan.msrcn else ()),
    )
    for part in parts:
        yield _unguarded(part.topic, [flow.publisher for flow in part.flows], part.successors)


def _of_app(scan: ScanResult | None) -> Iterator[PlanProblem]:
    if scan:
        app = AppFacts(GraphFacts(scan.graph, scan.lists or default_lists()))
        for topic in app.motion_topics:
            yield _unguarded(topic, app.publishers(topic), app.readers(topic))


def _unguarded(topic: str, publishers: Sequence[str], readers: Sequence[str]) -> PlanProblem:
    why = "its coordination node only observes: `mode: enforce` guards it"
    if "{" in topic:
        why = "cannot be guarded: its name is not known"
    elif not publishers:
        why = "no node is known to publish it"
    elif not readers:
        why = "no node is known to subscribe it"
    elif len(publishers) == 1:
        why = f"only {publishers[0]} publishes it: `mode: enforce` keeps every other node out"
    return PlanProblem(ProblemLevel.WARNING, topic, why)

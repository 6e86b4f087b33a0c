"""Check a plan, alone and for an app: what `rtron check` tells, and a guard before it starts."""

from collections.abc import Iterator

from rtron.planning.app_check import check_plan
from rtron.planning.plan_doubts import order_doubts, void_value_warnings
from rtron.planning.problem import PlanProblem
from rtron.vocabulary import InteractionGraph, Plan


def check(plan: Plan, graph: InteractionGraph | None = None) -> tuple[PlanProblem, ...]:
    """Return what is wrong with a plan, alone and for an app; then what is a guess in it."""
    doubts = plan_doubts(plan, graph or InteractionGraph(app=plan.app))
    return (*check_plan(plan, graph), *doubts)


def plan_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield what in a plan is a guess for this app, or has no effect."""
    yield from order_doubts(plan, graph) if graph.nodes else ()
    yield from void_value_warnings(plan)

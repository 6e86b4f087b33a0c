"""Check a plan, alone and for an app: what `rtron check` tells, and a guard before it starts."""

from collections.abc import Iterator

from rtron.errors import InputError
from rtron.planning.app_check import check_plan
from rtron.planning.plan_doubts import (
    open_way_doubts,
    order_doubts,
    silence_doubts,
    void_value_warnings,
)
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.vocabulary import InteractionGraph, Plan


def check(plan: Plan, graph: InteractionGraph | None = None) -> tuple[PlanProblem, ...]:
    """Return what is wrong with a plan, alone and for an app; then what is a guess in it."""
    doubts = plan_doubts(plan, graph or InteractionGraph(app=plan.app))
    return (*check_plan(plan, graph), *doubts)


def require_fit(plan: Plan, graph: InteractionGraph | None) -> Iterator[PlanProblem]:
    """Return what is odd in a plan; InputError if it is wrong, or does not fit the app."""
    problems = check(plan, graph)
    errors = [str(each) for each in problems if each.level is ProblemLevel.ERROR]
    if errors:
        help = "correct the plan, or make a new graph of the app"
        raise InputError("\n".join(("the plan does not fit the app", *errors)), help=help)
    return iter(problems)


def plan_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield what in a plan is a guess for this app, leaves a way past it, or has no effect."""
    yield from order_doubts(plan, graph) if graph.nodes else ()
    yield from open_way_doubts(plan, graph)
    yield from silence_doubts(plan, graph)
    yield from void_value_warnings(plan)

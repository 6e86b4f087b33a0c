"""Where the order of a plan's flows is a guess, because nothing tells what a publisher does."""

from collections.abc import Iterable, Iterator

from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.vocabulary import GRCN, InteractionGraph, Mode, Plan, PolicyName, matches_node

_BY_PRIORITY = (PolicyName.PREEMPTION, PolicyName.PRIORITY_QUEUE)


def order_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield a warning for each GRCN whose proposed order nobody has touched and that is a guess."""
    known = {node.name for node in graph.nodes if node.function}
    for grcn in plan.grcn:
        unknown = [f.publisher for f in grcn.flows if not _is_known(f.publisher, known)]
        is_ordered = grcn.mode is Mode.ENFORCE and grcn.policy in _BY_PRIORITY
        if unknown and is_ordered and len(grcn.flows) > 1 and _is_as_proposed(grcn):
            yield _doubt(grcn, unknown)


def _is_known(publisher: str, known: Iterable[str]) -> bool:
    return any(matches_node(publisher, node) for node in known)


def _is_as_proposed(grcn: GRCN) -> bool:
    """Return whether the priorities are those that a proposal counts down."""
    priorities = [flow.priority for flow in grcn.flows]
    return priorities == list(range(len(priorities), 0, -1))


def _doubt(grcn: GRCN, unknown: list[str]) -> PlanProblem:
    message = (
        f"nothing tells what these do: {', '.join(unknown)}; so the order is a guess: decide who "
        "goes first, and give the flows priorities of your own"
    )
    return PlanProblem(ProblemLevel.WARNING, f"GRCN {grcn.id}", message)

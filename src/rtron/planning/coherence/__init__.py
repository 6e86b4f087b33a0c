"""Whether a plan agrees with itself: what no single value shows. Each check yields its misfits."""

from collections.abc import Iterator, Sequence
from itertools import chain

from rtron.planning.coherence.flows import CoherenceProblem, duplicate_topic_problems, duplicates
from rtron.planning.coherence.grcn import grcn_problems
from rtron.planning.coherence.msrcn import msrcn_problems
from rtron.planning.coherence.rsrcn import rsrcn_problems
from rtron.planning.coherence.shared_topics import action_topic_problems, shared_topic_problems
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    EventFlow,
    FpsMonitor,
    GuardedTopic,
    Plan,
    normalise_type,
)

__all__ = ["CoherenceProblem", "coherence_problems"]


def coherence_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Yield everything in which a plan contradicts itself, its expressions apart."""
    yield from _id_problems(plan)
    yield from duplicate_topic_problems(plan.grcn, "GRCNs")
    yield from chain.from_iterable(map(grcn_problems, plan.grcn))
    yield from rsrcn_problems(plan)
    yield from msrcn_problems(plan.msrcn) if plan.msrcn else ()
    yield from shared_topic_problems(plan)
    yield from action_topic_problems(plan)
    yield from _type_problems(plan)
    for message in duplicates(plan.messages, lambda message: normalise_type(message.type)):
        yield message, "type", f"{message.type} has two definitions"


def _type_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    """Refuse a topic that has another type than elsewhere in the plan."""
    vflows = plan.rsrcn.vflows if plan.rsrcn else ()
    aflows, eflows = (plan.msrcn.aflows, plan.msrcn.eflows) if plan.msrcn else ((), ())
    parts: Sequence[GRCN | GuardedTopic | EventFlow] = [*plan.grcn, *vflows, *aflows, *eflows]
    first: dict[str, str] = {}
    for part in parts:
        known = first.setdefault(part.topic, part.type) if part.type else ""
        if normalise_type(part.type) != normalise_type(known):
            yield part, "type", f"{part.topic} is a {part.type} here and a {known} elsewhere"


def _id_problems(plan: Plan) -> Iterator[CoherenceProblem]:
    single = [node for node in (plan.rsrcn, plan.msrcn) if node]
    nodes: Sequence[GRCN | RSRCN | MSRCN | FpsMonitor] = [*plan.grcn, *single, *plan.fps_monitor]
    for node in duplicates(nodes, lambda node: node.id):
        yield node, "id", f"two coordination nodes have the id {node.id}"

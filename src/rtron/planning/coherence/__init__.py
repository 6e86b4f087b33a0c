"""Whether a plan agrees with itself: what no single value shows. Each check yields its misfits."""

from collections.abc import Iterator, Sequence
from itertools import chain

from rtron.planning.coherence.flows import Misfit, repeated, same_topic
from rtron.planning.coherence.grcn import grcn_misfits
from rtron.planning.coherence.msrcn import msrcn_misfits
from rtron.planning.coherence.rsrcn import rsrcn_misfits
from rtron.planning.coherence.shared_topics import action_misfits, shared_misfits
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

__all__ = ["Misfit", "misfits"]


def misfits(plan: Plan) -> Iterator[Misfit]:
    """Yield everything in which a plan contradicts itself, its expressions apart."""
    yield from _ids(plan)
    yield from same_topic(plan.grcn, "GRCNs")
    yield from chain.from_iterable(map(grcn_misfits, plan.grcn))
    yield from rsrcn_misfits(plan)
    yield from msrcn_misfits(plan.msrcn) if plan.msrcn else ()
    yield from shared_misfits(plan)
    yield from action_misfits(plan)
    yield from _types(plan)
    for message in repeated(plan.messages, lambda message: normalise_type(message.type)):
        yield message, "type", f"{message.type} has two definitions"


def _types(plan: Plan) -> Iterator[Misfit]:
    """Refuse a topic that has another type than elsewhere in the plan."""
    vflows = plan.rsrcn.vflows if plan.rsrcn else ()
    aflows, eflows = (plan.msrcn.aflows, plan.msrcn.eflows) if plan.msrcn else ((), ())
    nouns: Sequence[GRCN | GuardedTopic | EventFlow] = [*plan.grcn, *vflows, *aflows, *eflows]
    first: dict[str, str] = {}
    for noun in nouns:
        known = first.setdefault(noun.topic, noun.type) if noun.type else ""
        if normalise_type(noun.type) != normalise_type(known):
            yield noun, "type", f"{noun.topic} is a {noun.type} here and a {known} elsewhere"


def _ids(plan: Plan) -> Iterator[Misfit]:
    single = [node for node in (plan.rsrcn, plan.msrcn) if node]
    nodes: Sequence[GRCN | RSRCN | MSRCN | FpsMonitor] = [*plan.grcn, *single, *plan.fps_monitor]
    for node in repeated(nodes, lambda node: node.id):
        yield node, "id", f"two coordination nodes have the id {node.id}"

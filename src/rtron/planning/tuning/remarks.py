"""What a run shows that no value mends: flows that never spoke, and strangers that did."""

from collections.abc import Iterator, Sequence

from rtron.planning.tuning.formatting import number
from rtron.planning.tuning.run_statistics import of_flow
from rtron.vocabulary import UNAPPROVED, Flow, Proposal, ProposalKind, StreamFigures


def remarks(node: str, flows: Sequence[Flow], stream: StreamFigures) -> Iterator[Proposal]:
    """Yield what there is to look at on one topic."""
    for flow in flows:
        if not of_flow(stream, flow).messages:
            why = f"{flow.publisher} never spoke: nothing can be said about it"
            yield _look(node, "publisher", why, 0, flow.name)
    for name in stream.strangers:
        why = f"{name} is not in the plan and published here: give it a flow, or leave it blocked"
        said = sum(each.messages for each in stream.flows if each.flow == UNAPPROVED)
        told = f" ({number(said, 'message')} of strangers in all)" if said else ""
        yield _look(node, "flows", why + told, said)


def _look(node: str, key: str, why: str, samples: int, flow: str = "") -> Proposal:
    return Proposal(kind=ProposalKind.LOOK, node=node, flow=flow, key=key, why=why, samples=samples)

"""What a run shows that no value mends: flows that never spoke, and strangers that did."""

from collections.abc import Iterator, Sequence

from rtron.planning.tuning.formatting import count_text
from rtron.planning.tuning.run_statistics import flow_statistics
from rtron.vocabulary import UNAPPROVED, Flow, StreamStatistics, TuningProposal, TuningProposalKind


def observations(
    node: str, flows: Sequence[Flow], stream: StreamStatistics
) -> Iterator[TuningProposal]:
    """Yield what there is to look at on one topic."""
    for flow in flows:
        if not flow_statistics(stream, flow).messages:
            why = f"{flow.publisher} never spoke: nothing can be said about it"
            yield _look_proposal(node, "publisher", why, 0, flow.name)
    for name in stream.strangers:
        why = f"{name} is not in the plan and published here: give it a flow, or leave it blocked"
        message_count = sum(each.messages for each in stream.flows if each.flow == UNAPPROVED)
        total = (
            f" ({count_text(message_count, 'message')} of strangers in all)"
            if message_count
            else ""
        )
        yield _look_proposal(node, "flows", why + total, message_count)


def _look_proposal(node: str, key: str, why: str, samples: int, flow: str = "") -> TuningProposal:
    return TuningProposal(
        kind=TuningProposalKind.LOOK, node=node, flow=flow, key=key, why=why, samples=samples
    )

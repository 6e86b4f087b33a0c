"""What a measured run proposes for a plan, as text: each value with the figures behind it."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary import (
    PROPOSALS_SCHEMA,
    SECOND,
    MeasuredRun,
    TuningProposal,
    TuningProposalKind,
)


def tuning_to_json(run: MeasuredRun, proposals: Sequence[TuningProposal]) -> dict[str, Any]:
    """Return the proposals as a document; values are written as in the plan."""
    return {
        "schema": PROPOSALS_SCHEMA,
        "app": run.app,
        "duration": run.duration / SECOND,
        "proposals": [asdict(each) for each in proposals],
    }


_STYLES = ("cyan", "", "", "bold green")
_HEADINGS = {
    TuningProposalKind.CHANGE: "What changes",
    TuningProposalKind.LOOK: "For you to look at",
    TuningProposalKind.KEEP: "What stays as it is",
}


def tuning_text(
    title: str,
    run: MeasuredRun,
    proposals: Sequence[TuningProposal],
    notes: Sequence[str] = (),
    next_step: str = "",
) -> Report:
    """Return the changes, what to look at, and what stays and why; then the command to go on."""

    def lines(page: TextPage) -> Iterator[Text]:
        yield _head(title, run)
        yield from _proposed(proposals, page)
        for note in notes:
            yield from paragraph(f"note: {note}", page, style="yellow")
        if next_step:
            yield from heading("Next")
            yield line((next_step, "bold green"), indent=2)

    return Report(lines)


def _head(title: str, run: MeasuredRun) -> Text:
    messages = sum(flow.messages for stream in run.streams for flow in stream.flows)
    summary = f"{counted(messages, 'message')} in {run.duration / SECOND:.0f} s"
    return line((title, "bold"), "  ", summary)


def _proposed(proposals: Sequence[TuningProposal], page: TextPage) -> Iterator[Text]:
    for kind, words in _HEADINGS.items():
        chosen = [each for each in proposals if each.kind is kind]
        if chosen or kind is TuningProposalKind.CHANGE:
            yield from heading(f"{words} ({len(chosen)})")
            yield from _rows(chosen, page)


def _rows(proposals: Sequence[TuningProposal], page: TextPage) -> Iterator[Text]:
    if not proposals:
        return
    rows = columns([_cells(each) for each in proposals], _STYLES, indent=2)
    for row, proposal in zip(rows, proposals, strict=True):
        yield row
        yield from paragraph(proposal.why, page, indent=4, style="dim")


def _cells(proposal: TuningProposal) -> tuple[str, ...]:
    value = proposal.before
    if proposal.kind is TuningProposalKind.CHANGE:
        value = f"{proposal.before} -> {proposal.after}"
    return proposal.node, proposal.flow, proposal.key, value

"""A replay as text: what would have become of each flow's messages, and when that changed."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary import (
    REPLAY_SCHEMA,
    SECOND,
    DecisionChange,
    ReplayFlowCounts,
    ReplayReport,
    ReplayStreamCounts,
)


def replay_to_json(replay: ReplayReport) -> dict[str, Any]:
    """Return a replay as a document; times are in seconds after the first message."""
    return {
        "schema": REPLAY_SCHEMA,
        "messages": replay.messages,
        "duration": replay.duration / SECOND,
        "streams": [asdict(stream) for stream in replay.streams],
        "changes": [{**asdict(each), "at": each.at / SECOND} for each in replay.changes],
        "changes_left_out": replay.unseen,
        "notes": list(replay.notes),
    }


_MOST_SHOWN = 40
_STYLES = ("cyan", "dim", "green", "", "red", "yellow")
_HEAD = ("flow", "publisher", "passed", "held", "dropped", "modified")
_DECISIONS = {"drop": "red", "modify": "yellow", "pass": "green", "stop": "bold red"}


def replay_text(title: str, replay: ReplayReport) -> Report:
    """Return the counts of every stream, and the first changes."""
    return Report(lambda page: _lines(title, replay, page))


def _lines(title: str, replay: ReplayReport, page: TextPage) -> Iterator[Text]:
    summary = f"{counted(replay.messages, 'message')} in {replay.duration / SECOND:.1f} s"
    yield line((title, "bold"), "  ", summary)
    for stream in replay.streams:
        yield from _stream(stream)
    if replay.changes:
        yield from heading("What changed, and when")
        yield from _changes(replay)
    for note in replay.notes:
        yield from paragraph(f"note: {note}", page, style="yellow")


def _stream(stream: ReplayStreamCounts) -> Iterator[Text]:
    stops = f", {counted(stream.stops, 'stop')}" if stream.stops else ""
    yield from heading(f"{stream.topic}  ({', '.join(stream.nodes)}{stops})")
    flows = [flow for flow in stream.flows if flow.publisher or _total(flow)]
    yield from columns([_HEAD, *map(_row, flows)], _STYLES, indent=2)


def _row(flow: ReplayFlowCounts) -> tuple[str, ...]:
    counts = (flow.passed, flow.held, flow.dropped, flow.modified)
    return (flow.flow, flow.publisher, *map(str, counts))


def _total(flow: ReplayFlowCounts) -> int:
    return flow.passed + flow.held + flow.dropped + flow.modified


def _changes(replay: ReplayReport) -> Iterator[Text]:
    for change in replay.changes[:_MOST_SHOWN]:
        yield _change(change)
    left = len(replay.changes) - _MOST_SHOWN + replay.unseen
    if left > 0:
        yield line(f"… and {counted(left, 'more change')}; see --format json", indent=2)


def _change(change: DecisionChange) -> Text:
    decision = (f"{change.decision:<7}", _DECISIONS.get(change.decision, ""))
    where = (f"{change.topic} {change.flow}", "cyan")
    return line(f"{change.at / SECOND:>9.3f} s  ", decision, where, f"  {change.reason}", indent=2)

"""Incidents as text and as JSON: which there are, and what one tells."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from datetime import datetime, timezone
from itertools import islice
from typing import Any, TypeAlias

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary import (
    INCIDENT_SCHEMA,
    SECOND,
    Alternative,
    Comparison,
    IncidentAccount,
    IncidentHeader,
    ListedIncident,
    TopicAccount,
    Velocity,
)

ComparedAlternative: TypeAlias = tuple[Alternative, Sequence[Comparison]]
"""What would have been, and how that differs from what was."""
_MOST_SHOWN = 40
_FLOW_HEAD = ("flow", "publisher", "passed", "held", "dropped", "modified", "fastest")
_FLOW_STYLES = ("cyan", "dim", "green", "", "red", "yellow", "")
_DECISIONS = ("pass", "hold", "drop", "modify")
_STYLES = {"drop": "red", "modify": "yellow", "pass": "green", "stop": "bold red", "alarm": "red"}


def wall_time(at: int) -> str:
    """Return a time (ns since 1970) in UTC, to the millisecond; a time that no clock has as ns."""
    try:
        moment = datetime.fromtimestamp(at // 10**6 / 1000, tz=timezone.utc)
    except (OverflowError, ValueError, OSError):
        return f"{at} ns"
    return moment.isoformat(sep=" ", timespec="milliseconds").replace("+00:00", " UTC")


ListedFolder: TypeAlias = tuple[str, Sequence[ListedIncident]]
"""A folder, and the incidents in it, the oldest first."""


def incident_list_text(folders: Sequence[ListedFolder]) -> Report:
    """Return a line for each incident, by folder."""
    return Report(lambda page: (line for each in folders for line in _list_lines(*each, page)))


def _list_lines(folder: str, incidents: Sequence[ListedIncident], page: TextPage) -> Iterator[Text]:
    readable = [each for each in incidents if each.header]
    yield line((folder, "bold"), "  ", counted(len(incidents), "incident"))
    if readable:
        yield from columns(list(map(_list_row, readable)), ("cyan", "", "yellow"), indent=2)
    for each in incidents:
        if each.problem:
            yield from paragraph(f"note: {each.problem}", page, style="yellow")


def _list_row(incident: ListedIncident) -> tuple[str, ...]:
    header = incident.header
    if header is None:
        raise AssertionError("an incident that cannot be read has no row")
    cause, more = header.gravest, len(header.causes) - 1 + header.omitted_causes
    others = f" (and {counted(more, 'more cause')})" if more else ""
    what = f"{cause.topic} {cause.flow}".strip()
    size = f"{-(-incident.size // 1000)} kB"
    return incident.name, size, cause.kind, what, f"{cause.reason}{others}"


def incident_list_to_json(folders: Sequence[ListedFolder]) -> dict[str, Any]:
    """Return the incidents of folders as a document; times are in ns since 1970."""
    return {
        "schema": INCIDENT_SCHEMA,
        "folders": [
            {"folder": folder, "incidents": list(map(_listed_to_json, incidents))}
            for folder, incidents in folders
        ],
    }


def _listed_to_json(incident: ListedIncident) -> dict[str, Any]:
    return {
        "name": incident.name,
        "bytes": incident.size,
        "problem": incident.problem,
        "header": asdict(incident.header) if incident.header else None,
    }


def incident_text(
    name: str, account: IncidentAccount, alternative: ComparedAlternative | None = None
) -> Report:
    """Return what an incident tells: causes, who was in command, verdicts, and what changed."""
    return Report(lambda page: _lines(name, account, alternative, page))


def _lines(
    name: str, account: IncidentAccount, alternative: ComparedAlternative | None, page: TextPage
) -> Iterator[Text]:
    yield line((name, "bold"))
    yield from paragraph(_summary(account.header, account.span), page)
    yield from heading("Causes, and when (0 is the first)")
    yield from columns(
        [
            (_seconds(each.at - account.header.causes[0].at), each.kind, each.topic, each.flow,
             each.reason)
            for each in account.header.causes
        ],
        ("", "bold red", "cyan"),
        indent=2,
    )  # fmt: skip
    if alternative:
        yield from _alternative(*alternative, page)
    for topic, found in account.topics.items():
        yield from _topic(topic, found)
    if account.events:
        yield from heading("Beside the messages")
        rows = [
            (_seconds(each.at), each.kind, each.topic, each.reason)
            for each in islice(account.events, _MOST_SHOWN)
        ]
        yield from columns(rows, ("", "yellow", "cyan"), indent=2)
        yield from _left_out(len(account.events) - _MOST_SHOWN)


def _summary(header: IncidentHeader, span: tuple[int, int]) -> str:
    begin, end = span
    versions = f"ROS {header.ros} {header.distribution}".strip() + f", RTron {header.rtron}"
    return (
        f"{wall_time(header.causes[0].at)}, {header.app}, {versions}, settings revision "
        f"{header.revision}; from {_seconds(begin)} to {_seconds(end)}"
    )


def _alternative(
    alternative: Alternative, comparisons: Sequence[Comparison], page: TextPage
) -> Iterator[Text]:
    yield from heading(f"What would have been {alternative.title}")
    for each in comparisons:
        yield from paragraph(comparison_sentence(each), page)
    for note in alternative.notes:
        yield from paragraph(f"note: {note}", page, style="yellow")


def comparison_sentence(comparison: Comparison) -> str:
    """Return how an alternative differs from what went out on a topic."""
    if comparison.differs_from is None:
        return f"{comparison.topic}: the same went out"
    farther = comparison.alternative_way - comparison.actual_way
    way = f"; {abs(farther):.2f} m {'farther' if farther >= 0 else 'less far'} in all"
    areas = "".join(f"; into {name} after {when / SECOND:.1f} s" for name, when in comparison.areas)
    return (
        f"{comparison.topic}: {comparison.alternative:.2f} m/s instead of "
        f"{comparison.actual:.2f} m/s at {_seconds(comparison.at)}, the first difference at "
        f"{_seconds(comparison.differs_from)}{way}{areas}"
    )


def _topic(topic: str, account: TopicAccount) -> Iterator[Text]:
    yield from heading(f"{topic}  (output: {_fastest(account.output)})")
    flows = list(dict.fromkeys([*account.publishers, *(flow for flow, _ in account.verdicts)]))
    rows = [_flow_row(account, flow) for flow in flows]
    yield from columns([_FLOW_HEAD, *rows], _FLOW_STYLES, indent=2)
    yield Text()
    yield from _commanders(account)
    shown = account.changes[:_MOST_SHOWN]
    rows = [
        (_seconds(each.at), each.flow, each.decision, each.policy, each.reason) for each in shown
    ]
    if rows:
        yield line("what changed", indent=2)
        yield from columns(rows, ("", "cyan", "yellow", "dim"), indent=4)
    yield from _left_out(len(account.changes) - len(shown) + account.omitted_changes)


def _flow_row(account: TopicAccount, flow: str) -> tuple[str, ...]:
    counts = (str(account.verdicts[flow, decision]) for decision in _DECISIONS)
    fastest = _fastest(account.commands.get(flow, []))
    return (flow, account.publishers.get(flow, ""), *counts, fastest)


def _commanders(account: TopicAccount) -> Iterator[Text]:
    rows = [
        (_seconds(at), f"{owner or 'nobody'} {publisher}".strip(), stopping and f"stop: {stopping}")
        for at, owner, publisher, stopping in account.owners[:_MOST_SHOWN]
    ]
    if rows:
        yield line("who was in command", indent=2)
        yield from columns(rows, ("", "cyan", "bold red"), indent=4)
        yield from _left_out(len(account.owners) - len(rows))


def _left_out(number: int) -> Iterator[Text]:
    if number > 0:
        yield line(f"… and {number} more; see --format json", indent=4)


def _fastest(curve: Sequence[tuple[int, Velocity]]) -> str:
    speeds = [velocity.speed for _, velocity in curve if velocity.is_finite]
    return f"{max(speeds):.3g} m/s" if speeds else "-"


def _seconds(duration: int) -> str:
    return f"{duration / SECOND:+.2f} s"


def incident_to_json(
    name: str, account: IncidentAccount, alternative: ComparedAlternative | None = None
) -> dict[str, Any]:
    """Return what an incident tells as a document; times are in seconds after the first cause."""
    begin, end = account.span
    return {
        "schema": INCIDENT_SCHEMA,
        "name": name,
        "header": asdict(account.header),
        "begin": begin / SECOND,
        "end": end / SECOND,
        "topics": {topic: _topic_to_json(found) for topic, found in account.topics.items()},
        "events": [{**asdict(each), "at": each.at / SECOND} for each in account.events],
        "poses": {
            topic: [{**asdict(each), "at": each.at / SECOND} for each in poses]
            for topic, poses in account.poses.items()
        },
        "alternative": _alternative_to_json(*alternative) if alternative else None,
    }


def _alternative_to_json(
    alternative: Alternative, comparisons: Sequence[Comparison]
) -> dict[str, Any]:
    return {
        "title": alternative.title,
        "notes": list(alternative.notes),
        "topics": {
            each.topic: {
                "sentence": comparison_sentence(each),
                "at": each.at / SECOND,
                "speed": each.alternative,
                "actual_speed": each.actual,
                "way": each.alternative_way,
                "actual_way": each.actual_way,
                "areas": {name: when / SECOND for name, when in each.areas},
                "output": curve_to_json(alternative.outputs.get(each.topic, [])),
            }
            for each in comparisons
        },
    }


def _topic_to_json(account: TopicAccount) -> dict[str, Any]:
    return {
        "publishers": account.publishers,
        "verdicts": [
            {"flow": flow, "decision": decision, "count": count}
            for (flow, decision), count in account.verdicts.items()
        ],
        "commands": {flow: curve_to_json(curve) for flow, curve in account.commands.items()},
        "output": curve_to_json(account.output),
        "limits": [[at / SECOND, limit] for at, limit in account.limits],
        "owners": [
            {"at": at / SECOND, "owner": owner, "publisher": publisher, "stopping": stopping}
            for at, owner, publisher, stopping in account.owners
        ],
        "changes": [{**asdict(each), "at": each.at / SECOND} for each in account.changes],
        "changes_left_out": account.omitted_changes,
    }


def curve_to_json(curve: Sequence[tuple[int, Velocity]]) -> list[list[Any]]:
    """Return a curve as [seconds, linear, angular]; what is no number is left out."""
    return [
        [at / SECOND, list(velocity.linear), list(velocity.angular)]
        for at, velocity in curve
        if velocity.is_finite
    ]

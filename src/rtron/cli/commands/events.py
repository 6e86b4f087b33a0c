"""`rtron events` and `rtron upload-graph`."""

import json
import sys
from collections import Counter
from collections.abc import Mapping
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import Outcome, print_part
from rtron.cli.support.service_options import RobotOption, calls_service

if TYPE_CHECKING:
    from rtron.workflows.service_client import SecurityServiceClient

_PAGE = 1000
_LONGEST_GRAPH = 16 << 20
_MARKS = {"info": " ", "warning": "!", "error": "E"}


class EventLevel(str, Enum):
    """The least level to show."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


@calls_service
def events(  # noqa: PLR0913 - one for each option
    client: "SecurityServiceClient",
    *,
    robot: Annotated[str | None, typer.Option(metavar="NAME", help="Only this robot.")] = None,
    node: Annotated[
        str | None, typer.Option(metavar="ID", help="Only this coordination node.")
    ] = None,
    kind: Annotated[
        str | None, typer.Option(metavar="KIND", help="Only this kind: verdict, alarm, …")
    ] = None,
    level: Annotated[EventLevel, typer.Option(help="The least level.")] = EventLevel.INFO,
    follow: Annotated[bool, typer.Option("--follow", "-f", help="Go on with new events.")] = False,
    number: Annotated[
        int, typer.Option("--number", "-n", min=0, max=_PAGE, help="The number of past events.")
    ] = 20,
    format: Annotated[
        TextOrJson, typer.Option(help="A line of text or of JSON for each event.")
    ] = TextOrJson.TEXT,
) -> Outcome:
    """Show the events of guards: which flow has control, what was blocked and why.

    $ rtron events --token-file me.token
    $ rtron events --follow --robot car1 --level warning
    $ rtron events -f --format json | jq 'select(.kind == "verdict")'

    --follow reconnects to a service that was away, and then shows the missed
    events. Ctrl-C ends it.

    Exit code: 0 shown, 2 the service does not answer.
    """
    from rtron.workflows.service_events import follow_events

    event_filter = {"robot": robot, "node": node, "kind": kind, "level": level.value}
    stored_events = client.get("events", **event_filter, limit=number or 1)["events"]
    shown = list(reversed(stored_events[:number]))
    lines = "".join(_format_event(event, format) for event in shown)
    if not follow:
        return Outcome(lines)
    last = stored_events[0]["id"] if stored_events else 0
    live_events = follow_events(client, event_filter, last, _warn_of_lost_connection)
    is_read = print_part(lines)
    while is_read:
        is_read = print_part(_format_event(next(live_events), format))
    return Outcome("")


def _warn_of_lost_connection(error: Exception) -> None:
    sys.stderr.write(f"the service is away, trying again: {error}\n")


def _format_event(event: Mapping[str, Any], format: TextOrJson) -> str:
    return (json.dumps(event) if format is TextOrJson.JSON else _event_line(event)) + "\n"


def _event_line(event: Mapping[str, Any]) -> str:
    """Return an event, as the API shows it, on one line that a terminal survives; local time."""
    from rtron.sanitize import sanitize
    from rtron.vocabulary import SECOND

    at = datetime.fromtimestamp(event["at"] // SECOND).astimezone()
    what = event["decision"] or event["kind"]
    source = " ".join(filter(None, (event["node"], event["topic"], event["flow"])))
    who = f" by {event['publisher']}" if event["publisher"] else ""
    reason = f": {event['reason']}" if event["reason"] else ""
    mark = _MARKS.get(event["level"], "?")
    head = f"{at:%m-%d %H:%M:%S} {mark} {event['robot']} {what}"
    return sanitize(f"{head} {source}{who}{reason}".rstrip())


@calls_service
def upload_graph(
    client: "SecurityServiceClient",
    graph: Annotated[
        Path,
        typer.Argument(metavar="GRAPH.json", help="The interaction graph; - is standard input."),
    ],
    *,
    robot: RobotOption = "",
) -> Outcome:
    """Upload the interaction graph of a robot's app for the console.

    Without it the console draws only the nodes of the plan. The service finds
    the risks of the graph. Needs the role developer.

    $ rtron scan src --launch pkg/app.launch --format graph -o graph.json
    $ rtron upload-graph graph.json --robot car1 --token-file me.token

    Exit code: 0 stored, 2 rejected.
    """
    from rtron.reports.text_layout import counted
    from rtron.sources.bounded_file import read_bounded

    data = read_bounded(graph, _LONGEST_GRAPH)
    name = client.resolve_robot(robot)
    risks = client.put("robots", name, "graph", data=data)["risks"]
    kinds = Counter(risk["kind"] for risk in risks)
    kind_counts = ", ".join(f"{number} {kind}" for kind, number in sorted(kinds.items()))
    summary = f"{counted(len(risks), 'risk')}{f': {kind_counts}' if kind_counts else ''}"
    return Outcome(f"{name} has the graph; {summary}\n")

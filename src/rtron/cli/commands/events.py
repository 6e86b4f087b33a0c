"""`rtron events`."""

import json
import sys
from collections.abc import Mapping
from enum import Enum
from typing import Annotated, Any

import typer

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import Outcome, print_part
from rtron.cli.support.service_options import (
    DEFAULT_SERVICE,
    CaOption,
    ServiceOption,
    TokenOption,
    connect_to_service,
)

_PAGE = 1000


class EventLevel(str, Enum):
    """The least level to show."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


def events(  # noqa: PLR0913 - one for each option
    *,
    service: ServiceOption = DEFAULT_SERVICE,
    token_file: TokenOption = None,
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
    ca: CaOption = None,
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

    client = connect_to_service(service, token_file, ca)
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
    from rtron.reports.event_line import event_line

    return (json.dumps(event) if format is TextOrJson.JSON else event_line(event)) + "\n"

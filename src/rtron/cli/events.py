"""`rtron events`."""

import json
from collections.abc import Mapping
from enum import Enum
from typing import Annotated, Any

import typer

from rtron.cli.client import (
    DEFAULT_SERVICE,
    CaOption,
    ServiceOption,
    TokenOption,
    client,
)
from rtron.cli.following import followed
from rtron.cli.options import TextOrJson
from rtron.cli.outcome import Outcome, tell
from rtron.reports.event_line import event_line

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
    robot: Annotated[str | None, typer.Option(metavar="NAME", help="Of this robot only.")] = None,
    node: Annotated[
        str | None, typer.Option(metavar="ID", help="Of this coordination node only.")
    ] = None,
    kind: Annotated[
        str | None, typer.Option(metavar="KIND", help="Of this kind only: verdict, alarm, …")
    ] = None,
    level: Annotated[EventLevel, typer.Option(help="Of at least this level.")] = EventLevel.INFO,
    follow: Annotated[bool, typer.Option("--follow", "-f", help="Go on as they happen.")] = False,
    number: Annotated[
        int, typer.Option("--number", "-n", min=0, max=_PAGE, help="So many of the past.")
    ] = 20,
    ca: CaOption = None,
    format: Annotated[
        TextOrJson, typer.Option(help="A line each to read, or a line of JSON each.")
    ] = TextOrJson.TEXT,
) -> Outcome:
    """Show what the guards tell: who took control, what was refused and why.

    $ rtron events --token-file me.token
    $ rtron events --follow --robot car1 --level warning
    $ rtron events -f --format json | jq 'select(.kind == "verdict")'

    When the service is away while following, what happened meanwhile comes
    once it is there again. Ctrl-C ends it.

    Exit code: 0 shown, 2 the service does not answer.
    """
    called = client(service, token_file, ca)
    wanted = {"robot": robot, "node": node, "kind": kind, "level": level.value}
    past = called.get("events", **wanted, limit=number or 1)["events"]
    shown = list(reversed(past[:number]))
    lines = "".join(_line(event, format) for event in shown)
    if not follow:
        return Outcome(lines)
    coming = followed(called, wanted, past[0]["id"] if past else 0)
    is_read = tell(lines)
    while is_read:
        is_read = tell(_line(next(coming), format))
    return Outcome("")


def _line(event: Mapping[str, Any], format: TextOrJson) -> str:
    return (json.dumps(event) if format is TextOrJson.JSON else event_line(event)) + "\n"

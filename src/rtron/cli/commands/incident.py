"""`rtron incident`."""

import json
import shutil
from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Output, TextOrJson
from rtron.cli.support.outcome import STDOUT, Outcome, as_json, print_part
from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.sources.bag.incident import IncidentFile
    from rtron.vocabulary import Alternative, IncidentAccount

_SUMMARY = "Show and export what a guard has saved."
_GROUP_HELP = f"""{_SUMMARY}

The guard keeps the last minute of what passes through it, and of what decided
it. An intervention, a stop and an alarm save it, with some seconds behind, as
one MCAP file. Foxglove opens it as it is. See docs/incidents.md.

$ rtron incident list
$ rtron incident show last --without-guard
"""
incident = typer.Typer(name="incident", no_args_is_help=True, help=_SUMMARY)

IncidentArgument = Annotated[
    Path,
    typer.Argument(
        metavar="INCIDENT.mcap|last",
        help="A file that a guard has saved, or its name as `list` shows it.",
    ),
]
FormatOption = Annotated[TextOrJson, typer.Option(help="A report, or JSON.")]


class IncidentFormat(str, Enum):
    """What an export is for: Foxglove and other programs, a script, or a spreadsheet."""

    MCAP = "mcap"
    JSONL = "jsonl"
    CSV = "csv"


@incident.callback(help=_GROUP_HELP)
def incident_group() -> None:
    """Show and export incidents."""


@incident.command("list")
def list_folder(
    *,
    app: Annotated[
        str, typer.Option(metavar="NAME", help="The app of the plan; its usual folder is read.")
    ] = "",
    dir: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Another folder with incidents.")
    ] = None,
    format: FormatOption = TextOrJson.TEXT,
    output: Output = STDOUT,
) -> Outcome:
    """List the incidents of this user's guards, of one app, or in a folder.

    They are in incidents/ in the guard's --state-dir, by default below
    XDG_STATE_HOME/rtron/APP (~/.local/state/rtron/APP).

    $ rtron incident list
    $ rtron incident list --app turtlebot
    $ rtron incident list --dir /mnt/robot7/incidents --format json

    Exit code: 0 listed, 2 no such folder.
    """
    from rtron.reports.incident import incident_list_text, incident_list_to_json
    from rtron.workflows.incidents import incident_folder, list_incidents, usual_folders

    if app and dir:
        raise InputError("both --app and --dir", help="give one of them, or neither")
    one = dir or (incident_folder(app, None) if app else None)
    folders = [one] if one else usual_folders()
    found = [(str(folder), list_incidents(folder)) for folder in folders]
    if format is TextOrJson.JSON:
        return Outcome(as_json(incident_list_to_json(found)), to=output)
    if not found:
        return Outcome("no guard of this user has saved an incident\n", to=output)
    return Outcome(incident_list_text(found), to=output)


@incident.command()
def show(  # noqa: PLR0913 - one for each option
    file: IncidentArgument,
    *,
    without_guard: Annotated[
        bool, typer.Option("--without-guard", help="What the base would have got without it.")
    ] = False,
    as_planned: Annotated[
        bool, typer.Option("--as-planned", help="What the plan would have done, never changed.")
    ] = False,
    former_settings: Annotated[
        bool, typer.Option("--former-settings", help="What the settings before would have done.")
    ] = False,
    plan: Annotated[
        Path | None, typer.Option(metavar="PLAN.yaml", help="What another plan would have done.")
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE.png|FILE.svg", help="Draw the speeds and the path, too."),
    ] = None,
    format: FormatOption = TextOrJson.TEXT,
    output: Output = STDOUT,
) -> Outcome:
    """Show what an incident tells: who was in command, what was decided and why.

    JSON has the curves of all commands and outputs, too. Times are in seconds
    after the first cause, negative before it.

    $ rtron incident show last
    $ rtron incident show 20270112T101530.250Z-stop-cmd_vel.mcap
    $ rtron incident show incident.mcap --format json | jq '.topics[].verdicts'

    What would have been: the recorded commands go through the policies of
    another plan, of the recorded one under other settings, or past all of them.
    What alarms and people did is not played.

    $ rtron incident show incident.mcap --without-guard
    $ rtron incident show incident.mcap --without-guard --picture incident.png
    $ rtron incident show incident.mcap --plan other.yaml
    $ rtron incident show incident.mcap --former-settings

    The path is where a topic of events says that the robot was, if one does.
    What would have been goes on from there by dead reckoning of the commands.

    Exit code: 0 shown, 2 no incident, or a damaged one.
    """
    from rtron.reports.incident import incident_text, incident_to_json
    from rtron.sources.bag.incident import IncidentFile
    from rtron.workflows.incidents import find_incident, read_account
    from rtron.workflows.what_if import compare, plan_areas

    opened = IncidentFile(find_incident(file))
    account = read_account(opened)
    alternatives = {
        "without_guard": without_guard,
        "as_planned": as_planned,
        "under_former_settings": former_settings,
    }
    found = _alternative(
        opened, account, plan, [name for name, is_on in alternatives.items() if is_on]
    )
    areas = plan_areas(opened) if found else ()
    alternative = (found, compare(account, found, areas)) if found else None
    if picture:
        from rtron.demos.plots.incident import draw_incident

        draw_incident(picture, account, found, plan_areas(opened))
    if format is TextOrJson.JSON:
        document = incident_to_json(opened.path.name, account, alternative)
        return Outcome(as_json(document), to=output)
    return Outcome(incident_text(opened.path.name, account, alternative), to=output)


def _alternative(
    opened: "IncidentFile", account: "IncidentAccount", plan: Path | None, names: list[str]
) -> "Alternative | None":
    """Return what a function of `what_if` gives by its name, or what another plan would do."""
    from rtron.planning.plan_file.loader import read_plan
    from rtron.workflows import what_if

    if len(names) + bool(plan) > 1:
        help = "give one of --without-guard, --as-planned, --former-settings and --plan"
        raise InputError("several things that would have been", help=help)
    if plan:
        return what_if.under_plan(opened, read_plan(plan, opened.definitions), f"under {plan}")
    match names:
        case ["without_guard"]:
            return what_if.without_guard(account)
        case ["as_planned"]:
            return what_if.as_planned(opened)
        case ["under_former_settings"]:
            return what_if.under_former_settings(opened)
    return None


@incident.command()
def export(
    file: IncidentArgument,
    *,
    format: Annotated[
        IncidentFormat, typer.Option(help="MCAP as it is, a line of JSON for each row, or CSV.")
    ] = IncidentFormat.JSONL,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Write it there, not to the terminal."),
    ] = None,
) -> Outcome:
    """Write all messages and decisions of an incident for other programs.

    A row has `at`, `seconds` after the first cause, and its `kind`: command,
    output, verdict, control (who is in command, the limit), observed (frame
    rates, events), rule, alarm, settings, lost. Velocities are in m/s and rad/s.

    $ rtron incident export incident.mcap | jq 'select(.kind == "verdict")'
    $ rtron incident export incident.mcap --format csv -o incident.csv
    $ rtron incident export incident.mcap --format mcap -o /mnt/usb/incident.mcap

    Exit code: 0 written, 2 no incident, a damaged one, or nowhere to write it.
    """
    from rtron.sources.bag.incident import IncidentFile
    from rtron.workflows.incidents import find_incident

    opened = IncidentFile(find_incident(file))
    try:
        if format is IncidentFormat.MCAP:
            _copy(opened.path, output)
        else:
            _write_lines(_lines(opened, format), output)
    except OSError as error:
        raise InputError(error.strerror or "cannot be written", path=str(output)) from None
    return Outcome("")


@incident.command()
def report(file: IncidentArgument, *, output: Output = STDOUT) -> Outcome:
    """Write what a guard tells its service of an incident: a document of some 20 kB.

    It has the causes, who was in command, the verdicts that changed, speeds in
    300 steps, paths, and what would have been. The file itself stays where it is.

    $ rtron incident report last | jq '.alternatives[].sentences'

    Exit code: 0 written, 2 no incident, or a damaged one.
    """
    from rtron.reports.incident import comparison_sentence
    from rtron.sources.bag.incident import IncidentFile
    from rtron.wire.common.incident_report import encode_report
    from rtron.workflows.incident_report import incident_report
    from rtron.workflows.incidents import find_incident

    found = incident_report(IncidentFile(find_incident(file)), comparison_sentence)
    return Outcome(f"{encode_report(found).decode()}\n", to=output)


def _copy(file: Path, output: Path | None) -> None:
    if output is None:
        raise InputError("MCAP is not for a terminal", help="add -o FILE")
    if output.exists() and output.samefile(file):
        raise InputError("is the incident itself", path=str(output), help="choose another file")
    shutil.copyfile(file, output)


def _lines(opened: "IncidentFile", format: IncidentFormat) -> Iterable[str]:
    from rtron.reports.csv_lines import csv_lines
    from rtron.workflows.incidents import ROW_KEYS, export_rows

    rows = export_rows(opened)
    return csv_lines(rows, ROW_KEYS) if format is IncidentFormat.CSV else _json_lines(rows)


def _json_lines(rows: Iterable[dict[str, object]]) -> Iterator[str]:
    return (f"{json.dumps(row)}\n" for row in rows)


def _write_lines(lines: Iterable[str], output: Path | None) -> None:
    with output.open("w", encoding="utf-8", newline="") if output else nullcontext() as file:
        for each in lines:
            if file:
                file.write(each)
            elif not print_part(each):
                return

"""`rtron survey`."""

from collections.abc import Callable, Mapping
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Jobs, NoCache, Output
from rtron.cli.support.outcome import INTERRUPTED, STDOUT, Outcome, as_json
from rtron.cli.support.progress import show_progress
from rtron.cli.support.skipped_report import print_to_stderr, report_skipped
from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.reports.text_layout import Report
    from rtron.survey.survey_run import Survey


class SurveyFormat(str, Enum):
    """What a survey is written as."""

    JSONL = "jsonl"
    JSON = "json"
    CSV = "csv"
    HTML = "html"
    TABLE = "table"


def survey(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="A repository, or a folder of repositories.")
    ],
    *,
    format: Annotated[
        SurveyFormat | None,
        typer.Option(
            help="A line of JSON for each app, one JSON document, CSV, a page, or text.  "
            "[default: by the suffix of the output, else jsonl]",
            show_default=False,
        ),
    ] = None,
    table: Annotated[bool, typer.Option("--table", help="The same as --format table.")] = False,
    seconds: Annotated[
        float, typer.Option("--timeout", min=1, metavar="S", help="Seconds for each app.")
    ] = 120.0,
    jobs: Jobs = None,
    no_cache: NoCache = False,
    output: Output = STDOUT,
) -> Outcome:
    """Scan every app below a folder, a whole distribution if you like.

    Each launch file that no other includes, that needs no arguments and that is
    no test is an app of its own, of ROS 1 or ROS 2. The result has for each
    app: its risks by kind, the coordination nodes for them, its functions and
    its category, or the reason why it could not be scanned.

    $ rtron survey src --table
    $ rtron survey repositories/ -o apps.jsonl
    $ rtron survey repositories/ -o study.html     beside the paper's figures

    Results are kept as they come: after an end, Ctrl-C for instance, the same
    command goes on where it was, and scans again only what has changed.

    Exit code: 0 done, 2 no app could be scanned, 130 ended before.
    """
    from rtron.survey.survey_run import SurveyOptions, run_survey

    options = SurveyOptions(seconds=seconds, jobs=jobs, use_cache=not no_cache)
    with show_progress() as progress:
        found = run_survey(folder, options, progress)
    with report_skipped() as note_skipped:
        for skipped in (*found.failures(), *found.left_out):
            note_skipped(skipped)
    if found.missing:
        done = f"{len(found.results)} of {len(found.results) + found.missing} apps"
        print_to_stderr(f"ended after {done}; the same command goes on from there")
    elif not any(result.survey for result in found.results):
        help = "rtron scan DIR lists the launch files and the arguments that they need"
        raise InputError("no app can be scanned", path=str(folder), help=help)
    chosen = SurveyFormat.TABLE if table else format or _format_from_suffix(output)
    return Outcome(_RENDERERS[chosen](found), INTERRUPTED if found.missing else 0, to=output)


def _format_from_suffix(output: Path) -> SurveyFormat:
    """Return the format that a file's name asks for, JSON lines if it asks for none."""
    suffix = output.suffix.lower().removeprefix(".")
    return next((each for each in SurveyFormat if each.value == suffix), SurveyFormat.JSONL)


def _lines(found: "Survey") -> str:
    from rtron.survey.reports.files import survey_lines

    return survey_lines(found)


def _json(found: "Survey") -> str:
    from rtron.survey.reports.files import survey_document

    return as_json(survey_document(found))


def _csv(found: "Survey") -> str:
    from rtron.survey.reports.files import survey_csv

    return survey_csv(found)


def _html(found: "Survey") -> str:
    from rtron.survey.reports.page import survey_page

    return survey_page(found)


def _table(found: "Survey") -> "Report":
    from rtron.survey.reports.files import survey_text

    return survey_text(found)


_RENDERERS: Mapping[SurveyFormat, Callable[["Survey"], "str | Report"]] = {
    SurveyFormat.JSONL: _lines,
    SurveyFormat.JSON: _json,
    SurveyFormat.CSV: _csv,
    SurveyFormat.HTML: _html,
    SurveyFormat.TABLE: _table,
}

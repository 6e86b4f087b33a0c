"""`rtron survey`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.executor import ClusterAddress, ProcessCount, chosen_executor
from rtron.cli.options import Output
from rtron.cli.outcome import STDOUT, Outcome
from rtron.cli.progress import shown_progress
from rtron.cli.repositories import left_out
from rtron.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.executors import Executor
    from rtron.functions.reading import Note
    from rtron.survey.subjects import Subject
    from rtron.survey.surveyed import Surveyed


def survey(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="A repository, or a folder of repositories.")
    ],
    *,
    table: Annotated[
        bool, typer.Option("--table", help="Print how many apps have which risks instead.")
    ] = False,
    jobs: ProcessCount = None,
    cluster: ClusterAddress = None,
    output: Output = STDOUT,
) -> Outcome:
    """Scan every app below a folder, a whole distribution if you like.

    Each launch file of ROS 1 that needs no arguments is scanned as an app of
    its own. Each line of the result is an app: its risks by kind, the
    coordination nodes that they ask for, its functions and what kind of app
    it is.

    $ rtron survey src --table
    $ rtron survey repositories/ -o apps.jsonl
    $ rtron survey repositories/ --cluster tcp://10.0.0.7:8786

    The workers of a cluster must see the folder under the same path. What
    cannot be scanned is left out and told on standard error.

    Exit code: 0 scanned, 2 there is no app.
    """
    from rtron.survey.report import survey_line, survey_text  # noqa: PLC0415 - the guard starts without it
    from rtron.survey.subjects import subjects  # noqa: PLC0415 - the guard starts without it

    with left_out() as left:
        apps = list(subjects(folder, left))
        executor = chosen_executor(jobs, cluster, chunk=1, worth=len(apps) > 1)
        found = list(_scanned(apps, executor, left))
    if not found:
        help = "rtron scan DIR lists the launch files and the arguments that they need"
        raise InputError("no app can be scanned", path=str(folder), help=help)
    return Outcome(survey_text(found) if table else "".join(map(survey_line, found)), to=output)


def _scanned(apps: "list[Subject]", executor: "Executor", left: "Note") -> "Iterator[Surveyed]":
    from rtron.executors import Failed  # noqa: PLC0415 - the guard starts without it
    from rtron.functions.reading import Skipped  # noqa: PLC0415 - the guard starts without it
    from rtron.survey.scanning import scan_subject  # noqa: PLC0415 - the guard starts without it

    with shown_progress() as progress:
        results = executor.map(scan_subject, apps)
        for done, (app, result) in enumerate(zip(apps, results, strict=True), 1):
            progress(done, len(apps), app.app)
            if isinstance(result, Failed):
                left(Skipped(place=app.app, why=result.why))
            else:
                yield result

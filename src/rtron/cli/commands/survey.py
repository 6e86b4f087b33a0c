"""`rtron survey`."""

from operator import attrgetter
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import ClusterAddress, Output, ProcessCount
from rtron.cli.support.outcome import STDOUT, Outcome
from rtron.cli.support.progress import show_progress
from rtron.cli.support.skipped_report import report_skipped
from rtron.errors import InputError


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

    Each launch file of ROS 1 that needs no arguments is an app of its own. Each
    line of the result is an app: its risks by kind, the coordination nodes for
    them, its functions and its category.

    $ rtron survey src --table
    $ rtron survey repositories/ -o apps.jsonl
    $ rtron survey repositories/ --cluster tcp://10.0.0.7:8786

    The workers of a cluster must see the folder under the same path. Apps that
    cannot be scanned are skipped and listed on standard error.

    Exit code: 0 scanned, 2 no app.
    """
    from rtron.survey.app_listing import find_apps
    from rtron.survey.app_scan import scan_app
    from rtron.survey.report import survey_json_line, survey_text
    from rtron.workflows.parallel_map import choose_executor, map_with_progress

    with report_skipped() as note_skipped, show_progress() as progress:
        apps = list(find_apps(folder, note_skipped))
        executor = choose_executor(jobs, cluster, chunk=1, is_worth_parallel=len(apps) > 1)
        name = attrgetter("name")
        scanned = map_with_progress(executor, scan_app, apps, name, note_skipped, progress)
        results = [each for _, each in scanned]
    if not results:
        help = "rtron scan DIR lists the launch files and the arguments that they need"
        raise InputError("no app can be scanned", path=str(folder), help=help)
    return Outcome(
        survey_text(results) if table else "".join(map(survey_json_line, results)), to=output
    )

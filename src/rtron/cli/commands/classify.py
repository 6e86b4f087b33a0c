"""`rtron classify`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Output, Readmes
from rtron.cli.support.outcome import STDOUT, Outcome
from rtron.cli.support.progress import show_progress
from rtron.cli.support.skipped_report import report_skipped

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.functions.classifier.result import Classification


def classify(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FILE.jsonl|DIR|distribution.yaml",
            help="A line of JSON for each repository (- is standard input), a repository's folder "
            "or a folder of them, or rosdistro's list.",
        ),
    ],
    *,
    readmes: Readmes = None,
    table: Annotated[
        bool, typer.Option("--table", help="Print the paper's two tables instead.")
    ] = False,
    output: Output = STDOUT,
) -> Outcome:
    """Find the robot functions of repositories.

    Rules on names, then on the descriptions in manifests, then on the code
    (dependencies, plugins, message types), then on the README give each
    repository its function types: 17 in five domains, as in the paper. Each
    line of the result is a repository with how sure that is and why.

    $ rtron classify src/navigation                  a repository
    $ rtron classify src --table                     a folder of them
    $ rtron classify kinetic.jsonl --readmes readmes.jsonl -o classes.jsonl
    $ rtron classify humble/distribution.yaml        by names only

    Entries that cannot be read are skipped and listed on standard error.

    Exit code: 0 classified, 2 nothing can be read.
    """
    from rtron.functions.reading import read_repositories
    from rtron.workflows.function_graph import classify_repositories

    with report_skipped() as note_skipped, show_progress() as progress:
        repositories = read_repositories(source, readmes, note_skipped)
        classified = classify_repositories(repositories, note_skipped, progress)
        classifications = [each for _, each in classified]
    if table:
        from rtron.functions.classifier.tables import build_tables
        from rtron.reports.functions.tables import tables_text

        return Outcome(tables_text(build_tables(classifications)), to=output)
    return Outcome(_json_lines(classifications), to=output)


def _json_lines(classifications: "Iterable[Classification]") -> str:
    from rtron.reports.functions.json_documents import classification_to_json

    return "".join(json.dumps(classification_to_json(each)) + "\n" for each in classifications)

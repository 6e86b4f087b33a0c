"""`rtron classify`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.executor import ClusterAddress, ProcessCount
from rtron.cli.options import Output
from rtron.cli.outcome import STDOUT, Outcome
from rtron.cli.repositories import Readmes, left_out

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.functions.classification import Classification


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
    jobs: ProcessCount = None,
    cluster: ClusterAddress = None,
    output: Output = STDOUT,
) -> Outcome:
    """Find which robot functions repositories have.

    Rules over names, then manifests' descriptions, then the README give each
    repository its function types, 17 in five domains as in the paper. Each
    line of the result is a repository, with the words that decided.

    $ rtron classify src/navigation                  a repository
    $ rtron classify src --table                     a folder of them
    $ rtron classify kinetic.jsonl --readmes readmes.jsonl -o classes.jsonl
    $ rtron classify humble/distribution.yaml        names tell less
    $ rtron classify all.jsonl --cluster tcp://10.0.0.7:8786

    What cannot be read is left out and told on standard error.

    Exit code: 0 classified, 2 nothing can be read.
    """
    from rtron.cli.classifying import classified  # noqa: PLC0415 - the guard starts without it
    from rtron.functions.reading import read_repositories  # noqa: PLC0415 - the guard starts without it

    with left_out() as left:
        repositories = read_repositories(source, readmes, left)
        found = [each for _, each in classified(repositories, jobs, cluster, left)]
    if table:
        from rtron.functions.tables import count  # noqa: PLC0415 - the guard starts without it
        from rtron.reports.functions.tables import tables_text  # noqa: PLC0415 - the guard starts without it

        return Outcome(tables_text(count(found)), to=output)
    return Outcome(_as_lines(found), to=output)


def _as_lines(found: "Iterable[Classification]") -> str:
    from rtron.reports.functions.json_documents import classification_to_json  # noqa: PLC0415 - the guard starts without it

    return "".join(json.dumps(classification_to_json(each)) + "\n" for each in found)

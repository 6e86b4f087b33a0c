"""`rtron functions`."""

from collections.abc import Callable, Mapping
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Jobs, NoCache, Output, Readmes, TextOrJson
from rtron.cli.support.outcome import STDOUT, Outcome, as_json
from rtron.cli.support.progress import show_progress
from rtron.cli.support.skipped_report import report_skipped

if TYPE_CHECKING:
    from rtron.functions.interactions.abstract_graph import AbstractGraph

functions = typer.Typer(
    name="functions", no_args_is_help=True, help="Study the functions of robot apps."
)


class GraphFormat(str, Enum):
    """What the interaction graph of functions is written as."""

    JSON = "json"
    DOT = "dot"
    SVG = "svg"
    HTML = "html"


@functions.callback()
def functions_group() -> None:
    """Study an ecosystem: which functions exchange messages, and the categories of apps."""


@functions.command()
def graph(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="PATH",
            help="A folder of repositories, a corpus (JSON lines; - is standard input), or the "
            "distribution.yaml of rosdistro.",
        ),
    ],
    *,
    format: Annotated[
        GraphFormat | None,
        typer.Option(
            help="Data, or a picture.  [default: by the suffix of the output, else json]",
            show_default=False,
        ),
    ] = None,
    output: Output = STDOUT,
    readmes: Readmes = None,
    jobs: Jobs = None,
    no_cache: NoCache = False,
) -> Outcome:
    """Draw the interaction graph of functions: which exchange which messages.

    Each package has a function. Two functions interact directly if one
    publishes a message type that the other subscribes to, and indirectly if one
    acts on the environment that the other senses. For a folder, the types come
    from the source of its programs, otherwise from what is typical of a
    function; each edge says which.

    $ rtron functions graph repositories/ -o functions.svg
    $ rtron functions graph corpus.jsonl --readmes readmes.jsonl -o functions.html
    $ rtron functions graph distribution.yaml --format dot

    See docs/functions.md. Exit code: 0 drawn, 2 bad input.
    """
    from rtron.workflows.function_graph import build_function_graph
    from rtron.workflows.source_app import static_scan_options

    with report_skipped() as note_skipped, show_progress() as progress:
        options = static_scan_options(jobs, use_cache=not no_cache, progress=progress)
        drawn = build_function_graph(source, readmes, options, note_skipped)
    return Outcome(_RENDERERS[format or _format_from_suffix(output)](drawn), to=output)


@functions.command()
def apps(
    graphs: Annotated[
        list[Path],
        typer.Argument(
            metavar="GRAPH.json…", help="Interaction graphs of apps, or folders of such files."
        ),
    ],
    *,
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
    output: Output = STDOUT,
) -> Outcome:
    """Find the category of each app by the functions of its nodes.

    The 14 categories of the paper's table are sets of functions. An app is in
    the most specific categories whose functions it has.

    $ rtron scan src --launch pkg/app.launch --format graph --fail-on never -o app.json
    $ rtron functions apps app.json
    $ rtron functions apps graphs/ --format json

    Files that cannot be read are skipped and listed on standard error.

    Exit code: 0 done, 2 nothing can be read.
    """
    from rtron.functions.app_categories import count_categories
    from rtron.reports.functions.app_categories import apps_text, apps_to_json
    from rtron.workflows.function_graph import read_app_rows

    with report_skipped() as note_skipped:
        rows = read_app_rows(graphs, note_skipped)
    counted = count_categories(rows) if len(rows) > 1 else ()
    if format is TextOrJson.JSON:
        return Outcome(as_json(apps_to_json(rows, counted)), to=output)
    return Outcome(apps_text(rows, counted), to=output)


def _format_from_suffix(output: Path) -> GraphFormat:
    """Return the format that a file's name asks for, JSON if it asks for none."""
    suffix = output.suffix.lower().removeprefix(".")
    return next((each for each in GraphFormat if each.value == suffix), GraphFormat.JSON)


def _json(graph: "AbstractGraph") -> str:
    from rtron.reports.functions.json_documents import functions_to_json

    return as_json(functions_to_json(graph))


def _dot(graph: "AbstractGraph") -> str:
    from rtron.reports.functions.dot import functions_to_dot

    return functions_to_dot(graph)


def _svg(graph: "AbstractGraph") -> str:
    from rtron.reports.functions.svg import functions_to_svg

    return functions_to_svg(graph)


def _html(graph: "AbstractGraph") -> str:
    from rtron.reports.functions.html import functions_to_html

    return functions_to_html(graph)


_RENDERERS: Mapping[GraphFormat, Callable[["AbstractGraph"], str]] = {
    GraphFormat.JSON: _json,
    GraphFormat.DOT: _dot,
    GraphFormat.SVG: _svg,
    GraphFormat.HTML: _html,
}

"""`rtron functions`."""

from collections.abc import Callable, Mapping
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.options import Jobs, NoCache, Output, TextOrJson
from rtron.cli.outcome import STDOUT, Outcome, as_json
from rtron.errors import InputError
from rtron.functions.graph import AbstractGraph, abstract_graph
from rtron.sources.static.options import ScanOptions

functions = typer.Typer(
    name="functions", no_args_is_help=True, help="Study what the functions of robots are."
)


class GraphFormat(str, Enum):
    """What the interaction graph of functions is written as."""

    JSON = "json"
    DOT = "dot"
    SVG = "svg"
    HTML = "html"


@functions.callback()
def study() -> None:
    """Study an ecosystem: which functions exchange what, and what kind apps are of."""


@functions.command()
def graph(
    given: Annotated[
        Path,
        typer.Argument(
            metavar="PATH",
            help="A folder of repositories, a corpus (JSON lines; - is standard input), or the "
            "distribution.yaml of rosdistro.",
        ),
    ],
    *,
    format: Annotated[GraphFormat, typer.Option(help="Data, or a picture.")] = GraphFormat.JSON,
    output: Output = STDOUT,
    jobs: Jobs = None,
    no_cache: NoCache = False,
) -> Outcome:
    """Draw the interaction graph of functions: who exchanges which messages.

    Packages are sorted by function. Two functions interact directly if one
    publishes a message type that the other subscribes, and indirectly if
    one acts on the environment that the other senses. In a folder, types are
    read from the source of its programs; else from what is typical of a
    function. Each edge says which.

    $ rtron functions graph repositories/ --format svg -o functions.svg
    $ rtron functions graph corpus.jsonl --format html -o functions.html
    $ rtron functions graph distribution.yaml -o functions.json

    See docs/functions_graph.md. Exit code: 0 drawn, 2 bad input.
    """
    from rtron.cli.functions_input import package_uses  # noqa: PLC0415 - other commands start without it
    from rtron.sources.static.cache import user_cache  # noqa: PLC0415 - other commands start without it

    options = ScanOptions(cache=None if no_cache else user_cache())
    if jobs:
        options = ScanOptions(cache=options.cache, workers=jobs)
    found = abstract_graph(package_uses(given, options))
    return Outcome(_SHOWN[format](found), to=output)


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
    """Tell what kind of app each app is, by the functions of its nodes.

    The 14 categories are those of the paper's table, each a set of functions.
    Of those whose set an app has, the most specific are named.

    $ rtron scan src --launch pkg/app.launch --format graph --fail-on never -o app.json
    $ rtron functions apps app.json
    $ rtron functions apps graphs/ --format json

    Exit code: 0 told, 2 bad input.
    """
    from rtron.functions.apps import app_row, counts  # noqa: PLC0415 - other commands start without it
    from rtron.reports.functions_apps import apps_text, apps_to_json  # noqa: PLC0415 - nor this
    from rtron.sources.graph_json import read_graph  # noqa: PLC0415 - nor this

    files = _graph_files(graphs)
    rows = [app_row(read_graph(path), path.stem if len(files) > 1 else "") for path in files]
    counted = counts(rows) if len(rows) > 1 else ()
    if format is TextOrJson.JSON:
        return Outcome(as_json(apps_to_json(rows, counted)), to=output)
    return Outcome(apps_text(rows, counted), to=output)


def _graph_files(given: list[Path]) -> list[Path]:
    """Return the files, those in folders by name; raise InputError for a folder without any."""
    found: list[Path] = []
    for path in given:
        inside = sorted(path.glob("*.json")) if path.is_dir() else [path]
        if not inside:
            help = "write them with `rtron scan … --format graph -o app.json`"
            raise InputError("has no *.json", path=str(path), help=help)
        found += inside
    return found


def _json(graph: AbstractGraph) -> str:
    from rtron.reports.functions_graph_json import functions_to_json  # noqa: PLC0415 - one of four

    return as_json(functions_to_json(graph))


def _dot(graph: AbstractGraph) -> str:
    from rtron.reports.functions_graph_dot import functions_to_dot  # noqa: PLC0415 - one of four

    return functions_to_dot(graph)


def _svg(graph: AbstractGraph) -> str:
    from rtron.reports.functions_graph_svg import functions_to_svg  # noqa: PLC0415 - one of four

    return functions_to_svg(graph)


def _html(graph: AbstractGraph) -> str:
    from rtron.reports.functions_graph_html import functions_to_html  # noqa: PLC0415 - one of four

    return functions_to_html(graph)


_SHOWN: Mapping[GraphFormat, Callable[[AbstractGraph], str]] = {
    GraphFormat.JSON: _json,
    GraphFormat.DOT: _dot,
    GraphFormat.SVG: _svg,
    GraphFormat.HTML: _html,
}

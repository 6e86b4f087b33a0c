"""`rtron instrument`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.assignments import assignments
from rtron.cli.options import PlanOption, TextOrJson
from rtron.cli.outcome import FOUND, OK, Outcome, as_json
from rtron.planning.instrument import Instrumented, Started, write_instrumented
from rtron.planning.instrument import instrument as instrumented
from rtron.planning.read import parse_plan
from rtron.planning.yaml_text import read_text
from rtron.reports.guarded_text import Guarded, NodeRemap, OpenEnd, guarded_text, guarded_to_json
from rtron.sources.launch.packages import find_packages

if TYPE_CHECKING:
    from rtron.sources.static.app import StaticApp


def instrument(
    launch: Annotated[
        Path, typer.Argument(metavar="APP.launch", help="The launch file that starts the app.")
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="ARG:=VALUE", help="The launch file's arguments."),
    ] = None,
    *,
    plan: PlanOption,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="OUT.launch", help="The guarded launch file."),
    ],
    packages: Annotated[
        list[Path] | None,
        typer.Option(metavar="DIR", help="Look for packages here first; can be repeated."),
    ] = None,
    format: Annotated[
        TextOrJson, typer.Option(help="A report, or the same as JSON.")
    ] = TextOrJson.TEXT,
) -> Outcome:
    """Write a launch file that starts the app guarded.

    No node is changed: the guarded launch is the app's own, with remaps that
    lead each flow through the guard, and the guard. Launch files that nodes
    start themselves are found in the nodes' source and guarded in copies of
    their packages, which only those nodes see. Packages are looked for in
    --packages, then as ROS does.

    $ rtron instrument app.launch --plan rtron.yaml -o guarded.launch
    $ rtron instrument app.launch model:=waffle --plan rtron.yaml -o out.launch

    Exit code: 0 all is closed; 1 written, but something cannot be enforced and
    the plan does not accept it; 2 bad input.
    """
    from rtron.sources.static.app import scan_app  # noqa: PLC0415 - the guard starts without it

    text = read_text(plan)
    app = scan_app(packages or (), [(launch, assignments(arguments or ()))], os.environ)
    result = instrumented(
        app.trees[0],
        parse_plan(text, str(plan)),
        output,
        plan_text=text,
        started=_started(app),
        packages=find_packages(packages or ()),
    )
    write_instrumented(result)
    guarded = _guarded(result)
    shown = (
        as_json(guarded_to_json(guarded)) if format is TextOrJson.JSON else guarded_text(guarded)
    )
    return Outcome(shown, OK if guarded.is_closed else FOUND)


def _started(app: "StaticApp") -> Sequence[Started]:
    """Return what nodes start; the trees of it come after the app's own."""
    return [
        Started(tree=tree, by=file.by, evidence=(file.evidence,))
        for tree, file in zip(app.trees[1:], app.started, strict=True)
    ]


def _guarded(result: Instrumented) -> Guarded:
    return Guarded(
        launch=str(result.launch),
        files=tuple(map(str, (*result.files, *result.copies))),
        remaps=tuple(
            NodeRemap(node=r.node, topic=r.topic, written=r.written, target=r.target)
            for r in result.remaps
        ),
        unenforceable=tuple(
            OpenEnd(what=end.what, why=end.why, accepted=end.accepted)
            for end in result.unenforceable
        ),
        notes=result.notes,
    )

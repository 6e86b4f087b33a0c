"""`rtron instrument`."""

from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import PlanOption, TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json
from rtron.reports.plan.instrumentation import (
    InstrumentedLaunch,
    NodeRemap,
    UnenforceableNode,
    instrumentation_text,
    instrumentation_to_json,
)
from rtron.workflows.instrument import InstrumentRequest, InstrumentResult
from rtron.workflows.instrument import instrument as run_instrument
from rtron.workflows.launch_arguments import parse_assignments


def instrument(
    launch: Annotated[
        Path,
        typer.Argument(
            metavar="APP.launch",
            help="The launch file that starts the app; in ROS 2 one of .xml, .yaml or .py.",
        ),
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="ARG:=VALUE", help="The arguments it is to be launched with."),
    ] = None,
    *,
    plan: PlanOption,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="OUT.launch", help="The guarded launch; its kind is APP's."
        ),
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

    The plan says which ROS it is for. In ROS 2, XML and YAML launch files are
    rewritten; a Python launch file is wrapped: it stays as it is, and what it
    starts gets its remaps when it starts. RTron itself never runs it.

    $ rtron instrument app.launch.py --plan rtron.yaml -o guarded.launch.py
    $ rtron instrument app.launch.xml --plan rtron.yaml -o guarded.launch.xml

    XML and YAML are read for the arguments given, and for your environment:
    if others decide what starts, instrument again. A guarded launch that is
    started with the wrong ones ends at once and says which. A Python launch
    file takes any.

    Exit code: 0 all is closed; 1 written, but something cannot be enforced and
    the plan does not accept it; 2 bad input.
    """
    result = run_instrument(
        InstrumentRequest(
            launch=launch,
            arguments=parse_assignments(arguments or ()),
            folders=packages or (),
            plan=plan,
            output=output,
        )
    )
    guarded = _guarded_report(result)
    report = (
        as_json(instrumentation_to_json(guarded))
        if format is TextOrJson.JSON
        else instrumentation_text(guarded)
    )
    return Outcome(report, OK if guarded.is_closed else FINDINGS)


def _guarded_report(result: InstrumentResult) -> InstrumentedLaunch:
    written = result.launch
    return InstrumentedLaunch(
        ros=result.ros,
        launch=str(written.launch),
        files=tuple(map(str, (*written.files, *written.copies))),
        remaps=tuple(
            NodeRemap(node=r.node, topic=r.topic, written=r.written, target=r.target)
            for r in written.remaps
        ),
        unenforceable=tuple(
            UnenforceableNode(what=gap.what, why=gap.why, accepted=gap.accepted)
            for gap in written.unenforceable
        ),
        notes=written.notes,
    )

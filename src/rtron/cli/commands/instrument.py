"""`rtron instrument`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import Env, EnvAll, PlanOption, TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json
from rtron.workflows.launch_arguments import parse_assignments

if TYPE_CHECKING:
    from rtron.reports.plan.instrumentation import InstrumentedLaunch
    from rtron.workflows.instrument import InstrumentResult


def instrument(  # noqa: PLR0913 - one for each option
    launch: Annotated[
        str,
        typer.Argument(
            metavar="PKG/FILE",
            help="The launch file that starts the app, `pkg/file.launch` below --packages, or a "
            "path; in ROS 2 one of .xml, .yaml or .py.",
        ),
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="ARG:=VALUE", help="The arguments for the launch file."),
    ] = None,
    *,
    plan: PlanOption,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT.launch",
            help="The guarded launch file, of APP's kind.",
        ),
    ],
    graph: Annotated[
        Path | None,
        typer.Option(
            metavar="GRAPH.json",
            help="The app's graph: check the plan against it now and at each start.",
        ),
    ] = None,
    packages: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DIR",
            help="Search packages here first; can be repeated.",
        ),
    ] = None,
    env: Env = None,
    env_all: EnvAll = False,
    format: Annotated[
        TextOrJson, typer.Option(help="A report, or the same as JSON.")
    ] = TextOrJson.TEXT,
) -> Outcome:
    """Write a launch file that starts the app guarded.

    No node changes: the guarded launch file is the app's own, plus the guard,
    plus remaps that route each flow through the guard. Launch files that nodes
    start themselves are found in the source of the nodes; copies of their
    packages, which only those nodes see, hold the guarded ones.

    $ rtron instrument app.launch --plan rtron.yaml -o guarded.launch
    $ rtron instrument app.launch model:=waffle --plan rtron.yaml -o out.launch
    $ rtron instrument pkg/app.launch --packages src --plan rtron.yaml -o o.launch
    $ rtron instrument app.launch --plan rtron.yaml --graph g.json -o out.launch

    The plan names its ROS. For ROS 2, RTron rewrites XML and YAML launch files
    and wraps a Python one: the file stays as it is, and its nodes get their
    remaps when they start. RTron itself never runs it.

    $ rtron instrument app.launch.py --plan rtron.yaml -o guarded.launch.py
    $ rtron instrument app.launch.xml --plan rtron.yaml -o guarded.launch.xml

    A guarded XML or YAML file is valid for the given arguments and variables of
    the environment (--env). Started with others, it ends at once and names them;
    instrument again for those. A guarded Python launch file takes any arguments.

    Exit code: 0 every flow is guarded; 1 written, but nothing is guarded, or some
    flow cannot be and the plan does not accept that; 2 bad input.
    """
    from rtron.reports.plan.instrumentation import instrumentation_text, instrumentation_to_json
    from rtron.workflows.instrument import InstrumentRequest
    from rtron.workflows.instrument import instrument as run_instrument

    result = run_instrument(
        InstrumentRequest(
            launch=launch,
            arguments=parse_assignments(arguments or ()),
            folders=packages or (),
            env=env or (),
            env_all=env_all,
            plan=plan,
            output=output,
            graph=graph,
        )
    )
    guarded = _guarded_report(result)
    report = (
        as_json(instrumentation_to_json(guarded))
        if format is TextOrJson.JSON
        else instrumentation_text(guarded)
    )
    return Outcome(report, OK if guarded.is_closed and guarded.remaps else FINDINGS)


def _guarded_report(result: "InstrumentResult") -> "InstrumentedLaunch":
    from rtron.reports.plan.instrumentation import InstrumentedLaunch, NodeRemap, UnenforceableNode

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

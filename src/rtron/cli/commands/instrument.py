"""`rtron instrument`."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.support.options import PlanOption, TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json
from rtron.planning.instrument import GuardedLaunch, RuntimeLaunchTree, write_guarded_launch
from rtron.planning.instrument import instrument as instrumented
from rtron.planning.instrument.ros2 import instrument_ros2
from rtron.planning.plan_file.loader import parse_plan
from rtron.planning.plan_file.yaml_parser import read_text
from rtron.reports.plan.instrumentation import (
    InstrumentedLaunch,
    NodeRemap,
    UnenforceableNode,
    instrumentation_text,
    instrumentation_to_json,
)
from rtron.sources.launch.common.packages import find_packages
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.vocabulary import Plan
from rtron.workflows.instrument import check_launch_generation
from rtron.workflows.launch_arguments import parse_assignments

if TYPE_CHECKING:
    from rtron.sources.static.ros1.app import StaticApp


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
    text = read_text(plan)
    parsed_plan = parse_plan(text, str(plan))
    check_launch_generation(launch, parsed_plan, str(plan))
    request = _InstrumentRequest(
        launch, parse_assignments(arguments or ()), packages or (), parsed_plan, output, text
    )
    result = _instrument_ros1(request) if parsed_plan.ros == 1 else _instrument_ros2(request)
    write_guarded_launch(result)
    guarded = _guarded_report(result, parsed_plan.ros)
    report = (
        as_json(instrumentation_to_json(guarded))
        if format is TextOrJson.JSON
        else instrumentation_text(guarded)
    )
    return Outcome(report, OK if guarded.is_closed else FINDINGS)


@dataclass(frozen=True, slots=True)
class _InstrumentRequest:
    """What the command was given: a launch file and its arguments, where to look, what to make."""

    launch: Path
    arguments: Mapping[str, str]
    folders: Sequence[Path]
    plan: Plan
    out: Path
    plan_text: str


def _instrument_ros1(request: _InstrumentRequest) -> GuardedLaunch:
    from rtron.sources.static.ros1.app import scan_app  # noqa: PLC0415 - the guard starts without it

    app = scan_app(request.folders, [(request.launch, request.arguments)], os.environ)
    return instrumented(
        app.trees[0],
        request.plan,
        request.out,
        plan_text=request.plan_text,
        started=_started_launches(app),
        packages=find_packages(request.folders),
    )


def _instrument_ros2(request: _InstrumentRequest) -> GuardedLaunch:
    packages = find_packages(request.folders)
    tree = read_ros2_launch(request.launch, request.arguments, os.environ, packages)
    return instrument_ros2(tree, request.plan, request.out, plan_text=request.plan_text)


def _started_launches(app: "StaticApp") -> Sequence[RuntimeLaunchTree]:
    """Return what nodes start; the trees of it come after the app's own."""
    return [
        RuntimeLaunchTree(tree=tree, starter=file.started_by, evidence=(file.evidence,))
        for tree, file in zip(app.trees[1:], app.started, strict=True)
    ]


def _guarded_report(result: GuardedLaunch, ros: int) -> InstrumentedLaunch:
    return InstrumentedLaunch(
        ros=ros,
        launch=str(result.launch),
        files=tuple(map(str, (*result.files, *result.copies))),
        remaps=tuple(
            NodeRemap(node=r.node, topic=r.topic, written=r.written, target=r.target)
            for r in result.remaps
        ),
        unenforceable=tuple(
            UnenforceableNode(what=end.what, why=end.why, accepted=end.accepted)
            for end in result.unenforceable
        ),
        notes=result.notes,
    )

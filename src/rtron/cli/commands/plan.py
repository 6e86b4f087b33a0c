"""`rtron plan`."""

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from rtron.cli.support.options import (
    DEFAULT_MASTER,
    Domain,
    Env,
    Execute,
    Inputs,
    Jobs,
    Launches,
    LaunchPython,
    Lists,
    Live,
    LiveTimeout,
    Master,
    NoCache,
    Ros,
    RosOption,
    TextOrJson,
)
from rtron.cli.support.outcome import STDOUT, Outcome, replace_file, to_remarks
from rtron.errors import InputError
from rtron.planning.plan_file.writer import write_plan
from rtron.planning.proposal.policy_defaults import propose_plan, unguardable_topics
from rtron.reports.plan.plan_text import plan_text
from rtron.risks import discover_risks, load_lists
from rtron.workflows.app_selection import select_app, select_app_options
from rtron.workflows.tuning import TuningRequest, tune_from_run

_SUFFIXES = {1: ("",), 2: (".py", ".xml", ".yaml", ".yml")}
"""What a launch file's name has behind `.launch`, by ROS; the usual one first."""

Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="rtron.yaml", help="Write the plan; - prints it."),
]
FromRun = Annotated[
    Path | None,
    typer.Option("--from-run", metavar="RUN.json|BAG", help="Fit the plan to what a run measured."),
]
RunsPlan = Annotated[
    Path | None, typer.Option("--plan", metavar="rtron.yaml", help="The plan of that run.")
]
Format = Annotated[TextOrJson, typer.Option(help="What a run proposes: a report, or JSON.")]


def plan(  # noqa: PLR0913 - one for each option
    inputs: Inputs = None,
    *,
    launch: Launches = None,
    env: Env = None,
    execute_launch: Execute = False,
    launch_python: LaunchPython = None,
    live: Live = False,
    master: Master = DEFAULT_MASTER,
    ros: RosOption = Ros.AUTO,
    domain: Domain = None,
    timeout: LiveTimeout = None,
    lists: Lists = None,
    output: Output = None,
    from_run: FromRun = None,
    plan_file: RunsPlan = None,
    format: Format = TextOrJson.TEXT,
    jobs: Jobs = None,
    no_cache: NoCache = False,
) -> Outcome:
    """Propose what to put between the nodes of an app.

    The scan tells who can interfere with whom. The plan says which
    coordination nodes stand in between, which flow goes first and what is
    blocked. It is yours to edit: set the priorities, then check it.

    $ rtron plan graph.json                look at the proposal
    $ rtron plan src --launch pkg/app.launch -o rtron.yaml
    $ rtron plan src --launch pkg/app.launch.py --execute-launch
    $ rtron plan graph.json -o rtron.yaml  write it; an older one becomes .bak
    $ rtron plan graph.json -o -           print the YAML
    $ rtron plan --live -o rtron.yaml      of the app that is running
    $ rtron plan run.bag                   of what a bag shows, publishers only

    Later, fit it to how the app behaves. A dry run measures it:

    $ rtron guard --plan rtron.yaml --dry-run --figures run.json
    $ rtron plan --from-run run.json --plan rtron.yaml
    $ rtron plan --from-run run.json --plan rtron.yaml -o tuned.yaml
    $ rtron plan --from-run run.bag --plan rtron.yaml --format json

    --execute-launch RUNS the Python of the app's launch files, as in rtron scan.

    It proposes priorities, times and frame thresholds, each with the
    figures behind it. See docs/tuning.md.

    Exit code: 0 proposed, 2 bad input.
    """
    if from_run:
        if inputs or launch or live:
            help = "the app is that of the plan: leave the others out"
            raise InputError("--from-run and an app to read", help=help)
        return tune_from_run(
            TuningRequest(run=from_run, plan=plan_file, output=output, format=format)
        )
    if plan_file:
        raise InputError("--plan without --from-run", help="`rtron check` checks a plan")
    selection = select_app_options(
        inputs,
        launch,
        env,
        execute=execute_launch,
        python=launch_python,
        live=live,
        ros=ros,
        master=master,
        domain=domain,
        timeout=timeout,
        jobs=jobs,
        no_cache=no_cache,
    )
    app = select_app(selection)
    graph = app.source.read()
    report = discover_risks(graph, load_lists(lists) if lists else None)
    proposed = propose_plan(graph, report)
    if output == STDOUT:
        return Outcome(write_plan(proposed))
    if output:
        replace_file(output, write_plan(proposed))
    omitted = to_remarks(unguardable_topics(graph, report))
    if output is None:
        next_step = f"rtron plan {app.arguments} -o rtron.yaml"
        return Outcome(plan_text(proposed, next_step, omitted, graph.nodes))
    app_launch = next(iter((*app.launches, *(launch or ()))), None)
    next_step = _instrument_command(app_launch, output, proposed.ros)
    return Outcome(plan_text(proposed, next_step, omitted, graph.nodes))


def _instrument_command(app_launch: str | None, written: Path, ros: int) -> str:
    """Return the command that guards the app's launch file, as the plan's ROS has it."""
    usual, *others = _SUFFIXES[ros]
    suffix = next((end for end in others if (app_launch or "").endswith(end)), usual)
    named = quote(app_launch or f"APP.launch{suffix}")
    return f"rtron instrument {named} --plan {quote(str(written))} -o guarded.launch{suffix}"

"""`rtron plan`, and `rtron check` for a plan that somebody has edited."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from shlex import quote
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, NamedTuple
from xml.sax.saxutils import quoteattr

import typer

from rtron.cli.support.options import NameLists, TextOrJson, with_app_options
from rtron.cli.support.outcome import (
    FINDINGS,
    OK,
    STDOUT,
    Outcome,
    as_json,
    log_errors,
    replace_file,
)
from rtron.cli.support.progress import show_count, show_progress
from rtron.cli.support.skipped_report import print_to_stderr
from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.workflows.app_selection import AppSelection

PLAN_FILE, TUNED_FILE = "rtron.yaml", "tuned.yaml"

Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="rtron.yaml", help="Write the plan; - prints it."),
]
FromRun = Annotated[
    Path | None,
    typer.Option("--from-run", metavar="RUN.json|BAG", help="Fit a plan to a measured run."),
]
PlanOfRun = Annotated[
    Path | None, typer.Option("--plan", metavar="rtron.yaml", help="The plan of that run.")
]
EveryRisk = Annotated[
    bool, typer.Option("--every-risk", help="Also observe what moves nothing: images, transforms.")
]
Format = Annotated[TextOrJson, typer.Option(help="With --from-run: a report, or JSON.")]


@with_app_options
def plan(
    selection: "AppSelection",
    *,
    name_lists: NameLists = None,
    output: Output = None,
    from_run: FromRun = None,
    plan_file: PlanOfRun = None,
    every_risk: EveryRisk = False,
    format: Format = TextOrJson.TEXT,
) -> Outcome:
    """Propose a plan: the coordination nodes for an app.

    The scan finds what moves the robot and which nodes command it. The plan
    says which coordination nodes guard that, which flow has priority and what
    is blocked. Edit it: set the priorities, then run `rtron check`. With
    --every-risk it also observes the topics of risks that move nothing.

    $ rtron plan graph.json                show the proposal
    $ rtron plan src --launch pkg/app.launch -o rtron.yaml
    $ rtron plan src/pkg/launch/app.launch    with the source of its package
    $ rtron plan graph.json -o rtron.yaml  write it; an older one becomes .bak
    $ rtron plan graph.json -o -           print the YAML
    $ rtron plan --live -o rtron.yaml      for the running app
    $ rtron plan run.bag                   for the publishers in a bag

    Later, fit the plan to measurements of a dry run:

    $ rtron guard --plan rtron.yaml --dry-run --measurements run.json
    $ rtron plan --from-run run.json --plan rtron.yaml
    $ rtron plan --from-run run.json --plan rtron.yaml -o tuned.yaml
    $ rtron plan --from-run run.bag --plan rtron.yaml --format json

    `--from-run` proposes priorities, times and frame thresholds, with the
    measurements behind each. See docs/tuning.md.

    Exit code: 0 proposed; 1 proposed, but the plan guards nothing; 2 bad input.
    """
    if from_run:
        if selection.inputs or selection.source.launches or selection.live:
            help = "the plan says which app it is for: leave out the app's files and --live"
            raise InputError("--from-run cannot be combined with an app", help=help)
        return _fit_to_run(from_run, plan_file, output, format)
    if plan_file:
        raise InputError("--plan needs --from-run", help="`rtron check` checks a plan")
    return _propose(selection, name_lists, output, every_risk=every_risk)


def _propose(
    selection: "AppSelection", name_lists: Path | None, output: Path | None, *, every_risk: bool
) -> Outcome:
    from rtron.coherence import guards_nothing
    from rtron.planning.plan_file.writer import write_plan
    from rtron.reports.plan.plan_text import plan_text
    from rtron.reports.plan.problems import NOTHING_GUARDED
    from rtron.workflows.app_selection import select_app
    from rtron.workflows.plan import propose
    from rtron.workflows.scan import scan_graph

    with show_progress() as progress:
        app = select_app(selection, progress)
        graph = app.source.read()
    proposed = propose(scan_graph(graph, name_lists), every_risk=every_risk)
    exit_code = FINDINGS if guards_nothing(proposed.plan) else OK
    if output == STDOUT:
        print_to_stderr(*((NOTHING_GUARDED,) if exit_code else ()))
        return Outcome(write_plan(proposed.plan), exit_code)
    if output:
        replace_file(output, write_plan(proposed.plan))
        named = (Launch(Path(each)) for each in selection.source.launches)
        launches = [Launch(*each) for each in app.launches] or list(named)
        options = _instrument_options(selection, has_several=bool(launches[1:]))
        next_steps = list(instrument_commands(launches, output, proposed.plan.ros, options))
    else:
        option = " --every-risk" if every_risk else ""
        next_steps = [f"rtron plan {app.arguments}{option} -o {PLAN_FILE}"]
    text = plan_text(
        proposed.plan,
        () if exit_code else next_steps,
        proposed.omitted,
        graph.nodes,
        proposed.doubts,
        guess=app.guess,
    )
    return Outcome(text, exit_code)


def _instrument_options(selection: "AppSelection", *, has_several: bool) -> list[str]:
    """Return the environment, and the folders where a launch file lies outside of its package."""
    folders = selection.folders if has_several else []
    return [
        *(word for folder in folders for word in ("--packages", str(folder))),
        *selection.source.environment_options,
    ]


def _fit_to_run(run: Path, plan: Path | None, output: Path | None, format: TextOrJson) -> Outcome:
    """Return what a run proposes for its plan; write the plan if there is an `output`."""
    from rtron.planning.tuning import tuned_yaml
    from rtron.reports.plan.tuning import tuning_text, tuning_to_json
    from rtron.workflows.plan import tune_from_run

    if plan is None:
        help = "add --plan rtron.yaml, the plan that the run was measured under"
        raise InputError("--from-run needs --plan", help=help)
    if output == STDOUT and format is TextOrJson.JSON:
        help = "leave one of the two out, or give -o a file"
        raise InputError("both the plan and its figures would be printed", help=help)
    log_errors()
    with show_count("messages") as update:
        tuned = tune_from_run(run, plan, update)
    yaml = tuned_yaml(tuned.plan, tuned.proposals)
    if output == STDOUT:
        return Outcome(yaml)
    if output:
        replace_file(output, yaml)
    if format is TextOrJson.JSON:
        return Outcome(as_json(tuning_to_json(tuned.run, tuned.proposals)))
    command = f"rtron plan --from-run {quote(str(run))} --plan {quote(str(plan))} -o {TUNED_FILE}"
    next_step = f"rtron check {quote(str(output))}" if output else command
    return Outcome(tuning_text(str(run), tuned.run, tuned.proposals, tuned.notes, next_step))


def check(
    plan: Annotated[Path, typer.Argument(metavar="rtron.yaml", help="The plan.")],
    *,
    graph: Annotated[
        Path | None, typer.Option(metavar="GRAPH.json", help="Also compare the plan with this app.")
    ] = None,
) -> Outcome:
    """Check a plan that you edited.

    Each error comes with its line and the nearest valid word. It warns of
    values that leave a policy without effect. With the app's graph, it also
    finds topics and flows that nobody publishes, orders that are a guess, and
    what moves the robot and is in no coordination node.

    $ rtron check rtron.yaml
    $ rtron check rtron.yaml --graph graph.json

    Exit code: 0 good, 1 it guards nothing or does not fit the app, 2 bad input.
    """
    from rtron.coherence import guards_nothing
    from rtron.planning.plan_file.loader import read_plan
    from rtron.planning.problem import ProblemLevel
    from rtron.reports.plan.problems import problems_text
    from rtron.sources.graph_json import read_graph
    from rtron.workflows.check_plan import check as check_plan
    from rtron.workflows.scan import scan_graph
    from rtron.workflows.unguarded import find_unguarded_commands

    checked_plan = read_plan(plan)
    app_graph = read_graph(graph) if graph else None
    is_void = guards_nothing(checked_plan)
    problems = check_plan(checked_plan, app_graph)
    if app_graph or is_void:
        scan = scan_graph(app_graph) if app_graph else None
        problems += find_unguarded_commands(checked_plan, scan)
    failed = is_void or any(problem.level is ProblemLevel.ERROR for problem in problems)
    text = problems_text(str(plan), problems, is_void=is_void)
    return Outcome(text, FINDINGS if failed else OK)


_SUFFIXES = {1: ("",), 2: (".py", ".xml", ".yaml", ".yml")}
"""The end of a launch file's name behind `.launch`, by ROS; the usual one first."""
_ALL = {1: "all.launch", 2: "all.launch.yaml"}
"""The launch file that includes those of an app, by ROS."""


class Launch(NamedTuple):
    """A launch file and its arguments."""

    path: Path
    arguments: Mapping[str, str] = MappingProxyType({})


def instrument_commands(
    launches: Sequence[Launch], plan: Path, ros: int, options: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the commands that write the guarded launch of an app for a plan.

    An app has one guard: of several launch files, the first command writes one that includes them.
    `options` say where the app's packages are, and its environment.
    """
    usual, *others = _SUFFIXES[ros]
    shown, arguments = launches[0] if launches else Launch(Path(f"APP.launch{usual}"))
    if len(launches) > 1:
        including = _all_in_xml(launches) if ros == 1 else _all_in_yaml(launches)
        yield f"printf %s {quote(including)} > {_ALL[ros]}"
        shown, arguments = Launch(Path(_ALL[ros]))
    suffix = next((end for end in others if shown.name.endswith(end)), usual)
    given = [f"{name}:={value}" for name, value in arguments.items()]
    words = [_path_from_here(shown), *given, *options, "--plan", str(plan)]
    yield f"rtron instrument {' '.join(map(quote, words))} -o guarded.launch{suffix}"


def _all_in_xml(launches: Sequence[Launch]) -> str:
    includes = (
        f"<include file={quoteattr(str(path.absolute()))}>{_xml_arguments(given)}</include>"
        for path, given in launches
    )
    return f"<launch>{''.join(includes)}</launch>"


def _xml_arguments(given: Mapping[str, str]) -> str:
    pairs = (map(quoteattr, pair) for pair in given.items())
    return "".join(f"<arg name={name} value={value}/>" for name, value in pairs)


def _all_in_yaml(launches: Sequence[Launch]) -> str:
    """Return a launch file whose groups keep the arguments of each file from the next."""
    groups = [{"group": [{"include": _yaml_include(*each)}]} for each in launches]
    return json.dumps({"launch": groups})


def _yaml_include(path: Path, given: Mapping[str, str]) -> dict[str, object]:
    """Return what a launch file is included with; an empty list is an error in ROS 2."""
    arguments = [{"name": name, "value": value} for name, value in given.items()]
    return {"file": str(path.absolute())} | ({"arg": arguments} if arguments else {})


def _path_from_here(path: Path) -> str:
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)

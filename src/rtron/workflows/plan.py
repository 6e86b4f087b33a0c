"""Make a plan: propose one for an app, fit one to what a run measured, or check one."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.findings.inventory.node_roles import NodeRoles, measured_topics
from rtron.planning.app_check import check_plan
from rtron.planning.plan_doubts import (
    open_way_doubts,
    order_doubts,
    silence_doubts,
    void_value_warnings,
)
from rtron.planning.plan_file.loader import read_plan
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.planning.proposal.policy_defaults import propose_plan, unguardable_topics
from rtron.planning.tuning import tune_plan
from rtron.sources.bag.file_type import is_bag
from rtron.sources.run_json import read_run
from rtron.vocabulary import InteractionGraph, MeasuredRun, Plan, TuningProposal
from rtron.workflows.scan import ScanResult
from rtron.workflows.unguarded import find_unguarded_commands, last_commands, unguarded_requests


@dataclass(frozen=True, slots=True)
class ProposedPlan:
    """A plan for an app, what it leaves out, and what in it is a guess or has no effect."""

    plan: Plan
    omitted: tuple[PlanProblem, ...]
    doubts: tuple[PlanProblem, ...]


def propose(scan: ScanResult, *, every_risk: bool = False) -> ProposedPlan:
    """Return the plan that guards what moves the robot of an app, and watches what its rules need.

    With `every_risk` it has coordination nodes for the other risks, too, which only observe.
    """
    plan = propose_plan(
        scan.graph,
        replace(scan.report, viewers=(*scan.report.viewers, *_listeners(scan))),
        last_commands(scan),
        measured=measured_topics(scan.app),
        only_motion=not every_risk,
    )
    known = {each.name for mover in scan.inventory for each in mover.last_commands}
    unnamed = unguardable_topics(scan.graph, scan.report, only_motion=not every_risk)
    others = (each for each in unnamed if each.location not in known)
    omitted = (*others, *find_unguarded_commands(plan, scan))
    plan = replace(plan, unguarded=unguarded_requests(plan, scan))
    return ProposedPlan(plan, omitted, tuple(plan_doubts(plan, scan.graph)))


def _listeners(scan: ScanResult) -> Iterator[str]:
    """Yield the nodes that hear commands and obey none: they read the public names."""
    obeys = NodeRoles(scan.app).obeys
    return (node.name for node in scan.graph.nodes if not obeys(node.name))


@dataclass(frozen=True, slots=True, kw_only=True)
class TunedPlan:
    """A plan with what a run proposes for it; `notes` say what a bag does not tell."""

    plan: Plan
    proposals: tuple[TuningProposal, ...]
    run: MeasuredRun
    notes: tuple[str, ...]


def tune_from_run(run: Path, plan: Path, on_message: Callable[[int], None]) -> TunedPlan:
    """Return a plan fitted to a run, or to a bag that is played through the plan.

    `on_message` is called with the number of messages played. Raise InputError if one of the files
    cannot be read.
    """
    before, measured, notes = _read_run(run, plan, on_message)
    tuned, proposals = tune_plan(before, measured)
    return TunedPlan(plan=tuned, proposals=proposals, run=measured, notes=notes)


def _read_run(
    run: Path, plan: Path, on_message: Callable[[int], None]
) -> tuple[Plan, MeasuredRun, tuple[str, ...]]:
    if not is_bag(run):
        return read_plan(plan), read_run(run), ()
    from rtron.workflows.replay import measure_bag  # noqa: PLC0415 - needs the guard's policies

    return measure_bag(run, plan, on_message)


def read_checked_plan(text: str) -> Plan:
    """Return the plan of a document; PlanError or InputError tells all that is wrong with it.

    What reads plans is loaded only here: a guard that gets no plan never needs it.
    """
    from rtron.planning.plan_file.loader import parse_plan  # noqa: PLC0415 - see above

    plan = parse_plan(text)
    require_fit(plan, None)
    return plan


def check(plan: Plan, graph: InteractionGraph | None = None) -> tuple[PlanProblem, ...]:
    """Return what is wrong with a plan, alone and for an app; then what is a guess in it."""
    doubts = plan_doubts(plan, graph or InteractionGraph(app=plan.app))
    return (*check_plan(plan, graph), *doubts)


def require_fit(plan: Plan, graph: InteractionGraph | None) -> Iterator[PlanProblem]:
    """Return what is odd in a plan; InputError if it is wrong, or does not fit the app."""
    problems = check(plan, graph)
    errors = [str(each) for each in problems if each.level is ProblemLevel.ERROR]
    if errors:
        help = "correct the plan, or make a new graph of the app"
        raise InputError("\n".join(("the plan does not fit the app", *errors)), help=help)
    return iter(problems)


def plan_doubts(plan: Plan, graph: InteractionGraph) -> Iterator[PlanProblem]:
    """Yield what in a plan is a guess for this app, leaves a way past it, or has no effect."""
    yield from order_doubts(plan, graph) if graph.nodes else ()
    yield from open_way_doubts(plan, graph)
    yield from silence_doubts(plan, graph)
    yield from void_value_warnings(plan)

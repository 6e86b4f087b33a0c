"""Make a plan: propose one for an app, or fit one to what a run measured."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.findings.inventory.node_roles import NodeRoles, measured_topics
from rtron.planning.plan_file.loader import read_plan
from rtron.planning.problem import PlanProblem
from rtron.planning.proposal.policy_defaults import propose_plan, unguardable_topics
from rtron.planning.tuning import tune_plan
from rtron.sources.bag.file_type import is_bag
from rtron.sources.run_json import read_run
from rtron.vocabulary import MeasuredRun, Plan, TuningProposal
from rtron.workflows.check_plan import plan_doubts
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
    from rtron.workflows.check_plan import require_fit  # noqa: PLC0415 - see above

    plan = parse_plan(text)
    require_fit(plan, None)
    return plan

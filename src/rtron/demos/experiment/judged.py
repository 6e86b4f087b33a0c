"""A guarded run with what its guard told of it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rtron.demos.cases import Case
from rtron.demos.metrics.case_run import CaseRun
from rtron.demos.metrics.guard_events import SECOND, Event, first_stop
from rtron.demos.metrics.message_journal import time_to_mitigation
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import build_streams


def with_verdicts(run: CaseRun, case: Case, events: Sequence[Event], plan: Path) -> CaseRun:
    """Return a guarded run with what the guard told in its time, a second more for counts."""
    ended = run.start_wall + run.ended / run.speed + 1
    run_events = tuple(e for e in events if run.start_wall <= e["at"] / SECOND <= ended)
    stopped = first_stop(run_events, case.topic, case.attacker)
    after = time_to_mitigation(run.attack, stopped)
    return replace(run, events=run_events, mitigated_after=after, publishers=_publishers(plan))


def _publishers(plan: Path) -> dict[tuple[str, str], str]:
    found = build_streams(read_plan(plan))
    return {(each.topic, flow.name): flow.publisher for each in found for flow in each.flows}

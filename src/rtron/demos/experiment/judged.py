"""A guarded run with what its guard told of it."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rtron.demos.cases import Case
from rtron.demos.metrics.case_run import Run
from rtron.demos.metrics.guard_events import SECOND, Event, stopped_at
from rtron.demos.metrics.message_journal import mitigated_after
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import streams


def with_verdicts(run: Run, case: Case, events: Sequence[Event], plan: Path) -> Run:
    """Return a guarded run with what the guard told in its time, a second more for counts."""
    ended = run.began_wall + run.ended / run.speed + 1
    own = tuple(e for e in events if run.began_wall <= e["at"] / SECOND <= ended)
    stopped = stopped_at(own, case.topic, case.attacker)
    after = mitigated_after(run.attack, stopped)
    return replace(run, events=own, mitigated_after=after, publishers=_publishers(plan))


def _publishers(plan: Path) -> dict[tuple[str, str], str]:
    found = streams(read_plan(plan))
    return {(each.topic, flow.name): flow.publisher for each in found for flow in each.flows}

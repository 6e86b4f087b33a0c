"""How old an event may be: `max_age` and `silent` of an eflow.

Both outlast the gaps between its messages. `silent` is never made shorter, and neither is the
`max_age` of an event that pauses: such a source speaks when something changes.
"""

from dataclasses import replace

from rtron.planning.tuning.duration_fit import SILENCE_BOUNDS, describe_durations, fit_duration
from rtron.planning.tuning.run_statistics import AddProposal, PlanKey, RunStatistics
from rtron.vocabulary import EventFlow, EventStatistics


def tune_event_ages(
    node: str, flow: EventFlow, measured: RunStatistics, note: AddProposal
) -> EventFlow:
    """Return an eflow whose bit is known through the gaps of its source."""
    named = (each for each in measured.run.events if each.name == flow.name)
    figures = next(named, EventStatistics(name=flow.name))
    if flow.silent is not None:
        why = "an absence is not to be told too early"
        after = _fit_event_duration(node, flow, "silent", figures, note, why)
        return replace(flow, silent=after)
    if flow.when and flow.present is None:
        why = "it comes when something changes" if figures.pauses.count else ""
        return replace(flow, max_age=_fit_event_duration(node, flow, "max_age", figures, note, why))
    return flow


def _fit_event_duration(
    node: str,
    flow: EventFlow,
    key: str,
    figures: EventStatistics,
    note: AddProposal,
    objection: str,
) -> int:
    before: int = getattr(flow, key)
    fit = fit_duration(before, [figures.gaps], SILENCE_BOUNDS, objection=objection)
    plan_key = PlanKey(node=node, flow=flow.name, key=key)
    note(
        plan_key.proposal(before, fit, describe_durations(figures.gaps, "gap"), figures.gaps.count)
    )
    return fit.after

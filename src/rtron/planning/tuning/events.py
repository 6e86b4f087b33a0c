"""How old an event may be: `max_age` and `silent` of an eflow.

Both outlast the gaps between its messages. `silent` is never made shorter, and neither is the
`max_age` of an event that pauses: such a source speaks when something changes.
"""

from dataclasses import replace

from rtron.planning.tuning.duration_fit import SILENCE, measures, settle
from rtron.planning.tuning.run_statistics import Measured, Note, Place
from rtron.vocabulary import EventFigures, EventFlow


def with_ages(node: str, flow: EventFlow, measured: Measured, note: Note) -> EventFlow:
    """Return an eflow whose bit is known through the gaps of its source."""
    named = (each for each in measured.run.events if each.name == flow.name)
    figures = next(named, EventFigures(name=flow.name))
    if flow.silent is not None:
        why = "an absence is not to be told too early"
        after = _settled(node, flow, "silent", figures, note, why)
        return replace(flow, silent=after)
    if flow.when and flow.present is None:
        why = "it comes when something changes" if figures.pauses.count else ""
        return replace(flow, max_age=_settled(node, flow, "max_age", figures, note, why))
    return flow


def _settled(
    node: str, flow: EventFlow, key: str, figures: EventFigures, note: Note, objection: str
) -> int:
    before: int = getattr(flow, key)
    found = settle(before, [figures.gaps], SILENCE, objection=objection)
    place = Place(node=node, flow=flow.name, key=key)
    note(place.settled(before, found, measures(figures.gaps, "gap"), figures.gaps.count))
    return found.after

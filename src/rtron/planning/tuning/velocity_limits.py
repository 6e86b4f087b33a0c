"""The limits of the RSRCN, and its fps_monitors.

`threshold` (metres a frame) may become lower, never higher: 1.1 times the most that the robot went
in the time of a frame, so that the measured run would not have been limited. What would have been
limited is told; a higher limit is for a person to set. A monitor's `silent_after` follows from the
gaps between frames like any silence; its `window` becomes longer if it holds fewer than five
frames, or is shorter than the longest gap or than `silent_after`.
"""

from dataclasses import replace

from rtron.planning.coherence.rsrcn import BY_LIMIT, BY_RATE
from rtron.planning.plan_file.quantities import PER_FRAME, VELOCITY
from rtron.planning.tuning.duration_fit import FEW, SILENCE, measures, settle
from rtron.planning.tuning.formatting import number, round_up, round_up_value, written
from rtron.planning.tuning.run_statistics import Measured, Note, Place
from rtron.vocabulary import (
    RSRCN,
    SECOND,
    UNAPPROVED,
    FpsMonitor,
    MonitorFigures,
    Proposal,
    ProposalKind,
)

ENOUGH_SPEEDS = 1000
LONGEST_WINDOW = 60 * SECOND
_FRAMES = 5


def with_threshold(rsrcn: RSRCN, measured: Measured, note: Note) -> RSRCN:
    """Return an RSRCN whose threshold is no higher than the measured run needs."""
    streams = [measured.stream(topic.topic, rsrcn.mode) for topic in rsrcn.vflows]
    found = [stream for stream in streams if stream]
    most = max((stream.per_frame.max for stream in found), default=0.0)
    count = sum(stream.per_frame.count for stream in found)
    unseen = sum(stream.unseen for stream in found)
    if rsrcn.policy in BY_RATE and unseen:
        why = f"{number(unseen, 'velocity')} came while an image node was silent: `lowest` holds"
        note(_look(rsrcn, "lowest", VELOCITY.write(rsrcn.lowest), why, unseen))
    if rsrcn.threshold is None or rsrcn.policy not in BY_RATE:
        return rsrcn
    kind, after, why = _settled(rsrcn.threshold, most, count)
    note(
        Proposal(
            kind=kind,
            node=rsrcn.id,
            key="threshold",
            before=PER_FRAME.write(rsrcn.threshold),
            after=PER_FRAME.write(after),
            why=f"{number(count, 'velocity')}, at most {most:.3g} m a frame; {why}".rstrip("; "),
            samples=count,
        )
    )
    return replace(rsrcn, threshold=after)


def look_at_limit(rsrcn: RSRCN, measured: Measured, note: Note) -> None:
    """Tell what `max_vel_limit` would have limited."""
    limit = rsrcn.max_vel_limit
    if limit is None or rsrcn.policy not in BY_LIMIT:
        return
    for topic in rsrcn.vflows:
        stream = measured.stream(topic.topic, rsrcn.mode)
        for flow in stream.flows if stream else ():
            speeds = flow.speeds
            if speeds.max > limit and flow.flow != UNAPPROVED:
                told = f"{topic.topic}, {flow.publisher}: up to {speeds.max:.3g} m/s"
                why = f"{told}, would be limited; a higher limit is yours to set"
                note(_look(rsrcn, "max_vel_limit", VELOCITY.write(limit), why, speeds.count))


def with_frames(monitor: FpsMonitor, measured: Measured, note: Note) -> FpsMonitor:
    """Return an fps_monitor that outlasts the usual gaps between frames."""
    named = (each for each in measured.run.monitors if each.id == monitor.id)
    figures = next(named, MonitorFigures(id=monitor.id))
    told = measures(figures.gaps, "gap")
    if figures.fps.count:
        told += f", {figures.fps.min:.3g} to {figures.fps.max:.3g} fps"
    longest = figures.pauses.max
    silent = f"the node was silent for {written(round_up(longest))}" if longest else ""
    found = settle(monitor.silent_after, [figures.gaps], SILENCE, objection=silent)
    place = Place(node=monitor.id, key="silent_after")
    note(place.settled(monitor.silent_after, found, told, figures.gaps.count))
    return _with_window(replace(monitor, silent_after=found.after), figures, told, note)


def _with_window(monitor: FpsMonitor, figures: MonitorFigures, told: str, note: Note) -> FpsMonitor:
    gaps, before = figures.gaps, monitor.window
    wanted = round_up(max(_FRAMES * gaps.p50, 5 * gaps.max // 4)) if gaps.count >= FEW else 0
    fits = wanted <= LONGEST_WINDOW
    after = max(before, monitor.silent_after, wanted if fits else 0)
    if after == before and fits:
        return monitor
    note(
        Proposal(
            kind=ProposalKind.CHANGE if after > before else ProposalKind.LOOK,
            node=monitor.id,
            key="window",
            before=written(before),
            after=written(after),
            why=told,
            samples=gaps.count,
        )
    )
    return replace(monitor, window=after)


def _settled(before: float, most: float, count: int) -> tuple[ProposalKind, float, str]:
    if count < ENOUGH_SPEEDS:
        return ProposalKind.KEEP, before, f"too little: {ENOUGH_SPEEDS} are needed"
    if most > before:
        why = "some would be limited; a higher threshold is yours to set"
        return ProposalKind.LOOK, before, why
    if not most:
        return ProposalKind.KEEP, before, "the robot stood still"
    wanted = max(round_up_value(1.1 * most), PER_FRAME.least)
    if wanted > 0.8 * before:
        return ProposalKind.KEEP, before, "it fits"
    return ProposalKind.CHANGE, wanted, ""


def _look(rsrcn: RSRCN, key: str, value: str, why: str, samples: int) -> Proposal:
    return Proposal(
        kind=ProposalKind.LOOK,
        node=rsrcn.id,
        key=key,
        before=value,
        after=value,
        why=why,
        samples=samples,
    )

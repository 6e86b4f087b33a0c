"""The limits of the RSRCN, and its fps_monitors.

`threshold` (metres a frame) may become lower, never higher: 1.1 times the most that the robot went
in the time of a frame, so that the measured run would not have been limited. What would have been
limited is told; a higher limit is for a person to set. A monitor's `silent_after` follows from the
gaps between frames like any silence; its `window` becomes longer if it holds fewer than five
frames, or is shorter than the longest gap or than `silent_after`.
"""

from dataclasses import replace

from rtron.coherence.rsrcn import FRAME_RATE_POLICIES, VELOCITY_LIMIT_POLICIES
from rtron.planning.plan_file.quantities import PER_FRAME, VELOCITY
from rtron.planning.tuning.formatting import count_text, plan_duration, round_up, round_up_value
from rtron.planning.tuning.run_statistics import (
    MIN_SAMPLES,
    SILENCE_BOUNDS,
    AddProposal,
    PlanKey,
    RunStatistics,
    describe_durations,
    fit_duration,
)
from rtron.vocabulary import (
    RSRCN,
    SECOND,
    UNAPPROVED,
    FpsMonitor,
    MonitorStatistics,
    TuningProposal,
    TuningProposalKind,
)

ENOUGH_VELOCITIES = 1000
MAX_WINDOW = 60 * SECOND
_FRAMES = 5


def tune_threshold(rsrcn: RSRCN, measured: RunStatistics, note: AddProposal) -> RSRCN:
    """Return an RSRCN whose threshold is no higher than the measured run needs."""
    streams = [measured.stream(topic.topic, rsrcn.mode) for topic in rsrcn.vflows]
    measured_streams = [stream for stream in streams if stream]
    most = max((stream.per_frame.max for stream in measured_streams), default=0.0)
    count = sum(stream.per_frame.count for stream in measured_streams)
    unseen = sum(stream.unseen for stream in measured_streams)
    if rsrcn.policy in FRAME_RATE_POLICIES and unseen:
        why = (
            f"{count_text(unseen, 'velocity')} came while an image node was silent: `lowest` holds"
        )
        note(_look_proposal(rsrcn, "lowest", VELOCITY.write(rsrcn.lowest), why, unseen))
    if rsrcn.threshold is None or rsrcn.policy not in FRAME_RATE_POLICIES:
        return rsrcn
    kind, after, why = _fit_threshold(rsrcn.threshold, most, count)
    note(
        TuningProposal(
            kind=kind,
            node=rsrcn.id,
            key="threshold",
            before=PER_FRAME.write(rsrcn.threshold),
            after=PER_FRAME.write(after),
            why=f"{count_text(count, 'velocity')}, at most {most:.3g} m a frame; {why}".rstrip(
                "; "
            ),
            samples=count,
        )
    )
    return replace(rsrcn, threshold=after)


def report_limited_velocities(rsrcn: RSRCN, measured: RunStatistics, note: AddProposal) -> None:
    """Tell what `max_vel_limit` would have limited."""
    limit = rsrcn.max_vel_limit
    if limit is None or rsrcn.policy not in VELOCITY_LIMIT_POLICIES:
        return
    for topic in rsrcn.vflows:
        stream = measured.stream(topic.topic, rsrcn.mode)
        for flow in stream.flows if stream else ():
            speeds = flow.speeds
            if speeds.max > limit and flow.flow != UNAPPROVED:
                location = f"{topic.topic}, {flow.publisher}: up to {speeds.max:.3g} m/s"
                why = f"{location}, would be limited; a higher limit is yours to set"
                note(
                    _look_proposal(rsrcn, "max_vel_limit", VELOCITY.write(limit), why, speeds.count)
                )


def tune_frame_monitor(
    monitor: FpsMonitor, measured: RunStatistics, note: AddProposal
) -> FpsMonitor:
    """Return an fps_monitor that outlasts the usual gaps between frames."""
    named = (each for each in measured.run.monitors if each.id == monitor.id)
    figures = next(named, MonitorStatistics(id=monitor.id))
    observed = describe_durations(figures.gaps, "gap")
    if figures.fps.count:
        observed += f", {figures.fps.min:.3g} to {figures.fps.max:.3g} fps"
    longest = figures.pauses.max
    silent = f"the node was silent for {plan_duration(round_up(longest))}" if longest else ""
    fit = fit_duration(monitor.silent_after, [figures.gaps], SILENCE_BOUNDS, objection=silent)
    plan_key = PlanKey(node=monitor.id, key="silent_after")
    note(plan_key.proposal(monitor.silent_after, fit, observed, figures.gaps.count))
    return _with_window(replace(monitor, silent_after=fit.after), figures, observed, note)


def _with_window(
    monitor: FpsMonitor, figures: MonitorStatistics, observed: str, note: AddProposal
) -> FpsMonitor:
    gaps, before = figures.gaps, monitor.window
    proposed = (
        round_up(max(_FRAMES * gaps.p50, 5 * gaps.max // 4)) if gaps.count >= MIN_SAMPLES else 0
    )
    fits = proposed <= MAX_WINDOW
    after = max(before, monitor.silent_after, proposed if fits else 0)
    if after == before and fits:
        return monitor
    note(
        TuningProposal(
            kind=TuningProposalKind.CHANGE if after > before else TuningProposalKind.LOOK,
            node=monitor.id,
            key="window",
            before=plan_duration(before),
            after=plan_duration(after),
            why=observed,
            samples=gaps.count,
        )
    )
    return replace(monitor, window=after)


def _fit_threshold(before: float, most: float, count: int) -> tuple[TuningProposalKind, float, str]:
    if count < ENOUGH_VELOCITIES:
        return TuningProposalKind.KEEP, before, f"too little: {ENOUGH_VELOCITIES} are needed"
    if most > before:
        why = "some would be limited; a higher threshold is yours to set"
        return TuningProposalKind.LOOK, before, why
    if not most:
        return TuningProposalKind.KEEP, before, "the robot stood still"
    proposed = max(round_up_value(1.1 * most), PER_FRAME.minimum)
    if proposed > 0.8 * before:
        return TuningProposalKind.KEEP, before, "it fits"
    return TuningProposalKind.CHANGE, proposed, ""


def _look_proposal(rsrcn: RSRCN, key: str, value: str, why: str, samples: int) -> TuningProposal:
    return TuningProposal(
        kind=TuningProposalKind.LOOK,
        node=rsrcn.id,
        key=key,
        before=value,
        after=value,
        why=why,
        samples=samples,
    )

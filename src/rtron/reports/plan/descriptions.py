"""What the settings of a plan mean, in words; what has its default goes unsaid."""

from collections.abc import Iterator

from rtron.vocabulary import (
    RSRCN,
    SECOND,
    Area,
    Audit,
    CommanderRank,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    IncidentRecording,
    MissionRule,
    OnError,
    OnForeign,
    OnSilence,
    PolicyName,
    StopProfile,
    Supervision,
    Transform,
    WhenUnknown,
)

_SILENT_AFTER = SECOND // 2
_LIMIT_UNITS = {
    "threshold": "m/frame",
    "max_vel_limit": "m/s",
    "max_turn_limit": "rad/s",
    "max_side_limit": "m/s",
    "max_accel_limit": "m/s2",
}
_BY_RATE = (PolicyName.SAFE, PolicyName.SAFE_CONSTRAIN)


def seconds(duration: int) -> str:
    """Return a duration (ns) in seconds."""
    return f"{duration / SECOND:g} s"


def describe_flow(flow: Flow) -> str:
    """Return a flow's rank, priority and times, and what its silence and its errors do."""
    return ", ".join(_flow(flow))


def _flow(flow: Flow) -> Iterator[str]:
    if flow.rank is not CommanderRank.AGENT:
        yield f"rank {flow.rank}"
    if flow.priority:
        yield f"priority {flow.priority}"
    if flow.timeout is not None:
        yield f"timeout {seconds(flow.timeout)}"
    if flow.on_silence is OnSilence.RELEASE:
        yield "no stop when silent"
    elif flow.silent_after != _SILENT_AFTER:
        yield f"stop when silent for {seconds(flow.silent_after)}"
    if flow.on_error is OnError.DROP:
        yield "no stop on errors"


def describe_event(flow: EventFlow) -> str:
    """Return what sets an eflow's bit, and what it counts as while nobody knows it."""
    what = f"message with {one_line(flow.when)}" if flow.when else "message"
    if flow.present is not None:
        text = f"set for {seconds(flow.present)} after a {what}"
    elif flow.silent is not None:
        text = f"set after {seconds(flow.silent)} without a {what}"
    else:
        text = f"set while {one_line(flow.when)}"
    return "; ".join((text, *_unknown(flow)))


def _unknown(flow: EventFlow) -> Iterator[str]:
    cases = (("when silent", flow.on_silence), ("on errors", flow.on_error))
    for case, counts in cases:
        if counts is not WhenUnknown.BLOCK:
            yield f"{case}: {counts}"


def describe_rule(rule: MissionRule) -> str:
    """Return when a rule blocks what, and what ends it."""
    when = "" if rule.when == "true" else f"while {one_line(rule.when)}: "
    action = f" where {one_line(rule.action)}" if rule.action else ""
    end = f" until {rule.require} has spoken" if rule.require else ""
    return f"{when}block {', '.join(rule.block)}{action}{end}"


def describe_limit(rsrcn: RSRCN) -> tuple[str, ...]:
    """Return the limits of an RSRCN that are given, whether its policy uses them or not."""
    found = [
        f"{name} {value:g} {unit}"
        for name, unit in _LIMIT_UNITS.items()
        if (value := getattr(rsrcn, name)) is not None
    ]
    if rsrcn.policy in _BY_RATE or rsrcn.lowest:
        found.append(f"{rsrcn.lowest:g} m/s while an image node is silent")
    return tuple(found)


def describe_monitor(monitor: FpsMonitor) -> str:
    """Return what an fps_monitor counts, and what bounds its rate."""
    counted = "frames" if monitor.source is FrameSource.FRAMES else "detections only,"
    camera = monitor.camera
    found = [f"counts {counted} over {seconds(monitor.window)}"]
    if camera:
        found.append(f"no faster than {camera.topic} of {camera.publisher}")
    if monitor.silent_after != SECOND:
        found.append(f"silent after {seconds(monitor.silent_after)}")
    return ", ".join(found)


def describe_area(area: Area) -> str:
    """Return an area's size in corners, and its frame."""
    return f"{len(area.polygon)} corners in {area.frame}"


def describe_transform(one: Transform) -> str:
    """Return where a frame lies in another."""
    return f"{one.source} lies in {one.target} at {one.x:g} m, {one.y:g} m, {one.yaw:g} rad"


def describe_stop(stop: StopProfile) -> str:
    """Return how the robot is stopped."""
    ramp = f"a ramp of {stop.decel:g} m/s2 and {stop.angular_decel:g} rad/s2"
    rest = f"at rest within {seconds(stop.within)}, then zeros for {seconds(stop.repeat)}"
    return f"{ramp}, every {seconds(stop.period)}, {rest}"


def describe_audit(audit: Audit) -> str:
    """Return how often the guarded nodes are asked who speaks to them, and what follows."""
    also = " and stop" if audit.on_foreign is OnForeign.STOP else ""
    return f"every {seconds(audit.period)}; a foreign publisher: alarm{also}"


def describe_supervision(bounds: Supervision) -> str:
    """Return when the supervisor stops the robot, and when it kills the guard."""
    stop, kill = seconds(bounds.stall_after), seconds(bounds.kill_after)
    deliver, audit = seconds(bounds.deliver_within), seconds(bounds.audit_within)
    within = f"deliver within {deliver}, audit {audit}, start {seconds(bounds.start_within)}"
    return f"no sign of life: stop after {stop}, kill after {kill}; {within}"


def one_line(expression: str) -> str:
    """Return an expression on one line."""
    return " ".join(expression.split())


def describe_incidents(recording: IncidentRecording) -> str:
    """Return what of the guard's work stays on disk."""
    if not recording.keep:
        return "nothing is kept"
    keep, after = seconds(recording.keep), seconds(recording.after)
    return f"the last {keep}, and {after} after a cause, in at most {recording.megabytes} MB"

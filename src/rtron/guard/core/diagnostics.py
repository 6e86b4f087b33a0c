"""The guard's reports about itself: the texts of `~active` and of `/diagnostics`."""

from collections.abc import Iterable, Iterator, Sequence

from rtron.guard.core.alarms import Alarms
from rtron.guard.core.losses import Losses
from rtron.guard.core.observations import Observations
from rtron.guard.core.pipeline import VerdictTally
from rtron.guard.core.report_messages import ERROR, OK, WARN, Status
from rtron.guard.core.stream import GuardedStream
from rtron.policies.mission.rule_status import RuleStatus
from rtron.policies.velocity_limit.frame_monitors import FrameRateReport
from rtron.vocabulary import SECOND

_IDLE = "idle"


def active_text(stream: GuardedStream) -> str:
    """Return who is in control of a stream, or why the robot is being stopped."""
    if stream.stop_controller.reason:
        lease = f"; {stream.lease_text}" if stream.lease else ""
        return f"stopping: {stream.stop_controller.reason}{lease}"
    if stream.lease:
        return stream.lease_text
    owner = stream.pipeline.owner
    publishers = {flow.name: flow.publisher for flow in stream.spec.flows}
    return f"{owner} {publishers.get(owner, '')}".strip() if owner else _IDLE


def stream_statuses(
    streams: Sequence[GuardedStream], observations: Observations, now: int
) -> Iterator[Status]:
    """Yield the state of every stream and rule at `now`."""
    yield from (_stream_status(each, now) for each in streams)
    yield from map(_rule_status, observations.mission.statuses.values())


def rate_statuses(observations: Observations, now: int) -> Iterator[Status]:
    """Yield the state of every image node at `now`."""
    for monitor in observations.rates.monitors.values():
        yield _rate_status(monitor.rate(now))


def emergency_statuses(why: str, *, dry_run: bool) -> Iterator[Status]:
    """Yield the emergency stop while it is in force."""
    if why:
        text = f"{why} (dry run, nothing is stopped)" if dry_run else why
        yield Status(ERROR, "rtron: emergency stop", text, {})


def alarm_statuses(alarms: Alarms, now: int) -> Iterator[Status]:
    """Yield the state of the alarms: one entry for all, and one for each active alarm."""
    active = alarms.active
    level, text = (ERROR, f"{len(active)} alarms") if active else (OK, "none")
    yield Status(level, "rtron: alarms", text, {"raised": str(alarms.raised)})
    for number, alarm in enumerate(active, start=1):
        values = {"topic": alarm.topic, "node": alarm.node, "peer": alarm.peer}
        values["active_for"] = f"{(now - (alarms.since(alarm) or now)) / SECOND:.1f} s"
        yield Status(ERROR, f"rtron: alarm {number}", f"{alarm.kind}: {alarm.reason}", values)


def _stream_status(stream: GuardedStream, now: int) -> Status:
    pipeline = stream.pipeline
    values = {flow: _counts(tally) for flow, tally in pipeline.tallies.items()}
    values |= _lost(stream)
    values |= {f"unapproved {node}": f"connected {n}" for node, n in stream.strangers.items()}
    values |= stream.details
    if stream.stop_controller.stop_count:
        values["stops"] = str(stream.stop_controller.stop_count)
    overrides = dict(_overrides(stream, now))
    values |= overrides
    level, message = _level(stream)
    if overrides or stream.losses.are_recent(now):
        level = max(level, WARN)
    name = f"{stream.spec.topic} ({', '.join(stage.id for stage in stream.spec.stages)})"
    return Status(level, f"rtron: {name}", message, values)


def _lost(stream: GuardedStream) -> dict[str, str]:
    """Return what was lost without a verdict, if anything was."""
    before = {f"lost before the guard, {f}": str(n) for f, n in stream.losses.before.items()}
    behind = {f"lost behind the guard, {t}": str(n) for t, n in stream.lost_behind.items()}
    return before | behind


def _level(stream: GuardedStream) -> tuple[int, str]:
    if stream.dry_run:
        return WARN, f"dry run, everything passes: {active_text(stream)}"
    if stream.stop_controller.reason:
        return ERROR, active_text(stream)
    if stream.strangers:
        return WARN, f"unapproved publishers: {', '.join(stream.strangers)}"
    return OK, active_text(stream)


def _overrides(stream: GuardedStream, now: int) -> Iterator[tuple[str, str]]:
    for id, policy in stream.override_policies.items():
        override = policy.active_override
        if override and now < override.until:
            remaining = (override.until - now) / SECOND
            yield f"overridden {id}", f"by {override.by}, {remaining:.0f} s left: {override.why}"


def _counts(tally: VerdictTally) -> str:
    return "; ".join(_count_texts(tally))


def _count_texts(tally: VerdictTally) -> Iterator[str]:
    modified = f", modified {tally.modified}" if tally.modified else ""
    yield f"passed {tally.passed}, held {tally.held}, dropped {tally.dropped}{modified}"
    if tally.last:
        yield tally.last.reason


def _rate_status(rate: FrameRateReport) -> Status:
    if rate.age is None:
        return Status(ERROR, f"rtron: {rate.monitor_id}", "silent", {"fps": "0"})
    values = {"fps": f"{rate.fps:.2f}", "age": f"{rate.age / SECOND:.3f} s"}
    return Status(OK, f"rtron: {rate.monitor_id}", f"{rate.fps:.1f} fps", values)


def event_statuses(losses: Iterable[Losses], now: int) -> Iterator[Status]:
    """Log what was lost of the events, and yield the topics where anything was."""
    for each in losses:
        each.update({}, now)
        if each.before:
            text = f"{sum(each.before.values())} events were lost: a rule may have needed them"
            level = WARN if each.are_recent(now) else OK
            values = {f"lost of {node}": str(count) for node, count in each.before.items()}
            yield Status(level, f"rtron: events on {each.topic}", text, values)


def _rule_status(rule_status: RuleStatus) -> Status:
    name = f"rtron: rule {rule_status.rule.name}"
    values = {"blocks": ", ".join(rule_status.rule.block)}
    if not rule_status.is_blocking:
        return Status(OK, name, "met" if rule_status.is_met else "does not hold", values)
    obligation = f"; {rule_status.rule.require} must follow" if rule_status.rule.require else ""
    return Status(WARN, name, rule_status.reason + obligation, values)

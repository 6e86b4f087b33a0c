"""What the guard says about itself: the texts of `~active` and of `/diagnostics`."""

from collections.abc import Iterator, Sequence

from rtron.guard.core.alarms import Alarms
from rtron.guard.core.observations import Senses
from rtron.guard.core.pipeline import Tally
from rtron.guard.core.report_messages import ERROR, OK, WARN, Status
from rtron.guard.core.stream import GuardedStream
from rtron.policies.mission.rule_status import Standing
from rtron.policies.velocity_limit.frame_monitors import Rate
from rtron.vocabulary import SECOND

_IDLE = "idle"


def active_text(guarded: GuardedStream) -> str:
    """Return who is in control of a stream, or why the robot is being stopped."""
    if guarded.stopper.why:
        return f"stopping: {guarded.stopper.why}"
    owner = guarded.pipeline.owner
    publishers = {flow.name: flow.publisher for flow in guarded.stream.flows}
    return f"{owner} {publishers.get(owner, '')}".strip() if owner else _IDLE


def statuses(guarded: Sequence[GuardedStream], senses: Senses, now: int) -> list[Status]:
    """Return the state of every stream, image node and rule at `now`."""
    rates = (monitor.rate(now) for monitor in senses.rates.monitors.values())
    return [
        *(_stream(each, now) for each in guarded),
        *map(_rate, rates),
        *map(_rule, senses.mission.standings.values()),
    ]


def emergency_statuses(why: str, *, dry_run: bool) -> Iterator[Status]:
    """Yield the emergency stop while it is in force."""
    if why:
        told = f"{why} (dry run, nothing is stopped)" if dry_run else why
        yield Status(ERROR, "rtron: emergency stop", told, {})


def alarm_statuses(alarms: Alarms, now: int) -> Iterator[Status]:
    """Yield the state of the alarms: one entry for all, and one for each that stands."""
    standing = alarms.standing
    level, told = (ERROR, f"{len(standing)} alarms") if standing else (OK, "none")
    yield Status(level, "rtron: alarms", told, {"raised": str(alarms.raised)})
    for number, alarm in enumerate(standing, start=1):
        values = {"topic": alarm.topic, "node": alarm.node, "peer": alarm.peer}
        values["stands"] = f"{(now - (alarms.since(alarm) or now)) / SECOND:.1f} s"
        yield Status(ERROR, f"rtron: alarm {number}", f"{alarm.kind}: {alarm.reason}", values)


def _stream(guarded: GuardedStream, now: int) -> Status:
    pipeline = guarded.pipeline
    values = {flow: _counts(tally) for flow, tally in pipeline.tallies.items()}
    values |= {f"unapproved {node}": f"connected {n}" for node, n in guarded.strangers.items()}
    values |= guarded.details
    if guarded.stopper.stops:
        values["stops"] = str(guarded.stopper.stops)
    overrides = dict(_overrides(guarded, now))
    values |= overrides
    level, message = _level(guarded)
    level = max(level, WARN) if overrides else level
    name = f"{guarded.stream.topic} ({', '.join(stage.id for stage in guarded.stream.stages)})"
    return Status(level, f"rtron: {name}", message, values)


def _level(guarded: GuardedStream) -> tuple[int, str]:
    if guarded.pipeline.closed:
        return ERROR, guarded.pipeline.closed
    if guarded.dry_run:
        return WARN, f"dry run, everything passes: {active_text(guarded)}"
    if guarded.stopper.why:
        return ERROR, active_text(guarded)
    if guarded.strangers:
        return WARN, f"unapproved publishers: {', '.join(guarded.strangers)}"
    return OK, active_text(guarded)


def _overrides(guarded: GuardedStream, now: int) -> Iterator[tuple[str, str]]:
    for id, policy in guarded.overridable.items():
        override = policy.override
        if override and now < override.until:
            left = (override.until - now) / SECOND
            yield f"overridden {id}", f"by {override.by}, {left:.0f} s left: {override.why}"


def _counts(tally: Tally) -> str:
    return "; ".join(_told(tally))


def _told(tally: Tally) -> Iterator[str]:
    modified = f", modified {tally.modified}" if tally.modified else ""
    yield f"passed {tally.passed}, held {tally.held}, dropped {tally.dropped}{modified}"
    if tally.last:
        yield tally.last.reason


def _rate(rate: Rate) -> Status:
    if rate.age is None:
        return Status(ERROR, f"rtron: {rate.monitor}", "silent", {"fps": "0"})
    values = {"fps": f"{rate.fps:.2f}", "age": f"{rate.age / SECOND:.3f} s"}
    return Status(OK, f"rtron: {rate.monitor}", f"{rate.fps:.1f} fps", values)


def _rule(standing: Standing) -> Status:
    name = f"rtron: rule {standing.rule.name}"
    values = {"blocks": ", ".join(standing.rule.block)}
    if not standing.blocks:
        return Status(OK, name, "met" if standing.met else "does not hold", values)
    obliges = f"; {standing.rule.require} must follow" if standing.rule.require else ""
    return Status(WARN, name, standing.reason + obliges, values)

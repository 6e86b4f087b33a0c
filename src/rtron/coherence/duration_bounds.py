"""The least and greatest durations: the one place that decides, for plans and for settings.

The plan file, its JSON Schema, the API and the settings of a guard are read within
`DURATION_RANGES`. A GRCN on commands may do less, `command_duration_problems`: a command tells the
robot where to go now, and a node that falls silent must not hold the robot's controls for long.
What is allowed and still odd is a doubt, for `rtron check`.
"""

from collections.abc import Iterator, Mapping

from rtron.coherence.flows import CoherenceProblem
from rtron.vocabulary import GRCN, SECOND, EventFlow, Flow, Mode, OnForeign, Plan, StreamKind
from rtron.vocabulary.plan import LONGEST_STALL

_MINUTE, _HOUR, _DAY = 60 * SECOND, 3600 * SECOND, 24 * 3600 * SECOND
LONGEST_SILENCE = 10 * SECOND
"""A velocity that is older than this says nothing of where the robot should go now."""
LONG_SILENCE = 2 * SECOND
LONG_EVENT_AGE = _MINUTE
_SHORT_ABSENCE = 8 * SECOND
"""In ROS 2 the audit of a new bulk process needs 6 s, of which it takes 4 s to know the domain."""
_SHORTEST_HOLD = SECOND // 100
"""With less, nobody keeps the output between two messages, and no priority holds."""
_SHORTEST_SILENCE = SECOND // 100
"""With less, every pause between two messages is a silence: the robot stops after each, or a rule
never learns that its event is there."""

DURATION_RANGES: Mapping[str, tuple[int, int]] = {
    "timeout": (0, _DAY),
    "release_after": (_SHORTEST_HOLD, _HOUR),
    "max_age": (0, _DAY),
    "EventFlow.max_age": (_SHORTEST_SILENCE, _DAY),
    "max_hold": (_SHORTEST_HOLD, _DAY),
    "silent_after": (_SHORTEST_SILENCE, LONGEST_SILENCE),
    "FpsMonitor.silent_after": (_SHORTEST_SILENCE, _MINUTE),
    "StopButton.silent_after": (SECOND // 20, _MINUTE),
    "present": (_SHORTEST_SILENCE, _DAY),
    "silent": (_SHORTEST_SILENCE, _DAY),
    "second_person": (SECOND, _HOUR),
    "ttl": (SECOND // 2, _HOUR),
    "window": (SECOND // 10, _MINUTE),
    "period": (SECOND // 1000, SECOND),
    "Audit.period": (SECOND // 100, SECOND // 10),
    "repeat": (0, _HOUR),
    "stall_after": (SECOND // 50, SECOND // 5),
    "kill_after": (SECOND // 2, 10 * SECOND),
    "deliver_within": (SECOND // 5, 5 * SECOND),
    "audit_within": (5 * SECOND, _MINUTE),
    "start_within": (2 * SECOND, 2 * _MINUTE),
    "within": (SECOND // 20, 10 * SECOND),
    "keep": (0, 10 * _MINUTE),
    "after": (SECOND // 2, _MINUTE),
}
"""The least and the greatest duration (ns) under a key, or under one noun's key."""


def command_duration_problems(grcn: GRCN) -> Iterator[CoherenceProblem]:
    """Yield the durations that are too long for commands."""
    if grcn.kind is not StreamKind.COMMAND:
        return
    for part, key, duration in _command_durations(grcn):
        if duration > LONGEST_SILENCE:
            yield part, key, f"{key} is {_seconds(duration)}: for commands {_LONGEST} at most"


def duration_doubts(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield the durations that are allowed and that few robots can bear: where, and why."""
    for grcn in plan.grcn:
        if grcn.mode is Mode.ENFORCE and grcn.kind is StreamKind.COMMAND:
            yield from ((f"GRCN {grcn.id}", message) for message in _long_waits(grcn))
    for where, flow in _velocity_flows(plan):
        if flow.silent_after > LONG_SILENCE:
            how_long = _seconds(flow.silent_after)
            yield where, f"silent_after is {how_long}: so long the robot goes on without a command"
    yield from (("supervision", message) for message in _odd_bounds(plan))
    for event in plan.msrcn.eflows if plan.msrcn else ():
        yield from ((f"MSRCN, {event.name}", message) for message in _long_events(event))


def _command_durations(grcn: GRCN) -> Iterator[tuple[GRCN | Flow, str, int]]:
    yield grcn, "release_after", grcn.release_after
    yield grcn, "max_age", grcn.max_age
    for flow in grcn.flows:
        if flow.timeout is not None:
            yield flow, "timeout", flow.timeout


def _long_waits(grcn: GRCN) -> Iterator[str]:
    for part, key, duration in _command_durations(grcn):
        if duration > LONG_SILENCE:
            whose = f"{part.name}: " if isinstance(part, Flow) else ""
            yield f"{whose}{key} is {_seconds(duration)}: {_CONSEQUENCES[key]}"


def _velocity_flows(plan: Plan) -> Iterator[tuple[str, Flow]]:
    for grcn in plan.grcn:
        yield from ((f"GRCN {grcn.id}, {flow.name}", flow) for flow in grcn.flows)
    for topic in plan.rsrcn.vflows if plan.rsrcn else ():
        yield from ((f"RSRCN, {flow.name}", flow) for flow in topic.flows)
    for topic in plan.msrcn.aflows if plan.msrcn else ():
        yield from ((f"MSRCN, {flow.name}", flow) for flow in topic.flows)


def _odd_bounds(plan: Plan) -> Iterator[str]:
    stall_after, audit_within = plan.supervision.stall_after, plan.supervision.audit_within
    if stall_after > LONGEST_STALL:
        yield f"stall_after is {_seconds(stall_after)}: so long the robot goes on without a guard"
    is_stopped = plan.ros != 1 and plan.audit.on_foreign is OnForeign.STOP
    if is_stopped and audit_within < _SHORT_ABSENCE:
        how_long = _seconds(audit_within)
        yield f"audit_within is {how_long}: a crash of the bulk process may stop the robot"


def _long_events(event: EventFlow) -> Iterator[str]:
    if event.present is None and event.silent is None and event.max_age > LONG_EVENT_AGE:
        yield f"max_age is {_seconds(event.max_age)}: an event of then still counts as true now"
    if (event.silent or 0) > LONG_EVENT_AGE:
        yield f"silent is {_seconds(event.silent or 0)}: so long nobody notices that it is gone"


def _seconds(duration: int) -> str:
    return f"{duration / SECOND:g} s"


_LONGEST = _seconds(LONGEST_SILENCE)
_CONSEQUENCES = {
    "release_after": "so long nobody else drives when a node falls silent",
    "timeout": "so long nobody else drives when this flow falls silent",
    "max_age": "commands of then still pass",
}

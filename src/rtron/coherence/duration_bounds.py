"""The least and greatest durations: the one place that decides, for plans and for settings.

The plan file, its JSON Schema, the API and the settings of a guard are read within
`DURATION_RANGES`. A GRCN on commands may do less, `command_duration_problems`: a command tells the
robot where to go now, and a node that falls silent must not hold the robot's controls for long.
What is allowed and still odd is a doubt, for `rtron check`.
"""

import math
import re
from collections.abc import Iterator, Mapping

from rtron.coherence.flows import CoherenceProblem
from rtron.vocabulary import (
    GRCN,
    SECOND,
    EmergencyStop,
    EventFlow,
    Flow,
    FlowSettings,
    Mode,
    NodeSettings,
    OnForeign,
    Plan,
    RuleSettings,
    Settings,
    StreamKind,
    TimedOverride,
)
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


MAX_INT64 = 2**63 - 1
"""The greatest revision, and the last moment, ns."""
PRIORITY_RANGE = (-(2**31), 2**31 - 1)
MAX_VELOCITY = 1000.0
"""The greatest `max_vel_limit`, m/s, and `threshold`, metres per frame."""
MIN_NONZERO_VELOCITY = 1e-6
"""Nothing but 0 is closer to 0: it would be a slip."""
MAX_RULES = 200
MAX_BLOCKED_FLOWS = 1000
MAX_NAME_LENGTH = 255
MAX_TEXT_LENGTH = 1000
MAX_CONDITION_LENGTH = 4096
MAX_CONDITIONS_LENGTH = 8192
"""All conditions that settings have together: messages wait while they are read."""
_RULE_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")


def bound_problems(settings: Settings) -> Iterator[str]:
    """Yield what in settings is out of its bounds, whatever the plan is."""
    yield from _integer_bounds("revision", settings.revision, 0, MAX_INT64)
    for id, node in settings.nodes.items():
        yield from (f"{_quoted(id)}: {problem}" for problem in _node(node))
    for id, override in settings.overrides.items():
        yield from (f"override of {_quoted(id)}: {problem}" for problem in _override(override))
    if settings.stop:
        yield from (f"emergency stop: {problem}" for problem in _stop(settings.stop))


def _node(node: NodeSettings) -> Iterator[str]:
    for name in ("release_after", "max_age", "max_hold"):
        yield from _duration_bounds(name, getattr(node, name))
    yield from _quantity_bounds("threshold", node.threshold, MIN_NONZERO_VELOCITY)
    if node.max_vel_limit != 0:
        yield from _quantity_bounds("max_vel_limit", node.max_vel_limit, MIN_NONZERO_VELOCITY)
    for name, flow in node.flows.items():
        yield from (f"{_quoted(name)}: {problem}" for problem in _flow(flow))
    if len(node.rules) > MAX_RULES:
        yield f"more than {MAX_RULES} rules"
    if sum(len(rule.when or "") for rule in node.rules.values()) > MAX_CONDITIONS_LENGTH:
        yield f"the conditions are longer than {MAX_CONDITIONS_LENGTH} characters together"
    for name, rule in node.rules.items():
        yield from (f"rule {_quoted(name)}: {problem}" for problem in _rule(name, rule))


def _flow(flow: FlowSettings) -> Iterator[str]:
    yield from _integer_bounds("priority", flow.priority, *PRIORITY_RANGE)
    yield from _duration_bounds("timeout", flow.timeout)


def _rule(name: str, rule: RuleSettings) -> Iterator[str]:
    if len(name) > MAX_NAME_LENGTH or not _RULE_NAME.fullmatch(name):
        yield "a rule's name is a word of letters, digits and _"
    if len(rule.when or "") > MAX_CONDITION_LENGTH:
        yield f"a condition is longer than {MAX_CONDITION_LENGTH} characters"
    if len(rule.block or ()) > MAX_BLOCKED_FLOWS:
        yield f"it blocks more than {MAX_BLOCKED_FLOWS} flows"


def _override(override: TimedOverride) -> Iterator[str]:
    yield from _integer_bounds("until", override.until, 0, MAX_INT64)
    yield from _author_text(override)


def _stop(stop: EmergencyStop) -> Iterator[str]:
    yield from _integer_bounds("at", stop.at, 0, MAX_INT64)
    yield from _author_text(stop)


def _author_text(entry: TimedOverride | EmergencyStop) -> Iterator[str]:
    for text in (entry.by, entry.reason):
        if len(text) > MAX_TEXT_LENGTH:
            yield f"a text is longer than {MAX_TEXT_LENGTH} characters"


def _duration_bounds(name: str, value: int | None) -> Iterator[str]:
    least, greatest = DURATION_RANGES[name]
    if value is not None and not least <= value <= greatest:
        yield f"{name} is not between {least / SECOND:g} s and {greatest / SECOND:g} s"


def _integer_bounds(name: str, value: int | None, least: int, greatest: int) -> Iterator[str]:
    if value is not None and not least <= value <= greatest:
        yield f"{name} is not between {least} and {greatest}"


def _quantity_bounds(name: str, value: float | None, least: float) -> Iterator[str]:
    if value is not None and not (math.isfinite(value) and least <= value <= MAX_VELOCITY):
        yield f"{name} is not between {least:g} and {MAX_VELOCITY:g}"


def _quoted(name: str) -> str:
    return repr(name[:MAX_NAME_LENGTH])

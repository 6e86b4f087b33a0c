"""The bounds of settings: they come over a network, and a guard asks this before anything else."""

import math
import re
from collections.abc import Iterator

from rtron.coherence.duration_bounds import DURATION_RANGES
from rtron.vocabulary import (
    SECOND,
    EmergencyStop,
    FlowSettings,
    NodeSettings,
    RuleSettings,
    Settings,
    TimedOverride,
)

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

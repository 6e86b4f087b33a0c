"""What of a plan may change while the app runs; everything else needs the app to be launched anew.

Another plan may set other policies, rules, limits, times, priorities and ranks. What is guarded,
how it is connected, and how the robot is watched and stopped stay as they are; so does what the
plan calls mandatory, and all that it depends on.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace

from rtron.vocabulary import GRCN, MSRCN, RSRCN, EventFlow, Flow, FpsMonitor, LeaseGroup, Plan

_CHANGEABLE: Mapping[type, frozenset[str]] = {
    Plan: frozenset({"revision", "unguarded"}),
    Flow: frozenset(
        {"priority", "block", "timeout", "silent_after", "on_silence", "on_error", "rank"}
    ),
    GRCN: frozenset({"policy", "release_after", "max_age", "max_hold"}),
    LeaseGroup: frozenset({"ttl", "service"}),
}
_LIMITS: Mapping[type, frozenset[str]] = {
    RSRCN: frozenset(
        {
            "policy",
            "threshold",
            "max_vel_limit",
            "max_turn_limit",
            "max_side_limit",
            "max_accel_limit",
            "lowest",
        }
    ),
    FpsMonitor: frozenset({"window", "silent_after"}),
}
"""Changeable unless a policy of the RSRCN is mandatory."""
_MISSION: Mapping[type, frozenset[str]] = {
    MSRCN: frozenset({"policy", "areas", "transforms"}),
    EventFlow: frozenset({"when", "present", "silent", "max_age", "on_silence", "on_error"}),
}
"""Changeable unless a rule of the MSRCN is mandatory."""


def relaunch_reasons(current: Plan, new: Plan) -> Iterator[str]:
    """Yield where a new plan differs from the one in force so that the app must be launched anew.

    Each is a place in the plan: `grcn drive: topic`.
    """
    yield from _differences(
        _with_mandatory_rules(current), _with_mandatory_rules(new), _changeable(current), ""
    )


def _changeable(plan: Plan) -> Mapping[type, frozenset[str]]:
    has_mandatory_limit = plan.rsrcn is not None and plan.rsrcn.mandatory is not None
    has_mandatory_rule = plan.msrcn is not None and any(each.mandatory for each in plan.msrcn.rules)
    limits = {} if has_mandatory_limit else _LIMITS
    mission = {} if has_mandatory_rule else _MISSION
    return {**_CHANGEABLE, **limits, **mission}


def _with_mandatory_rules(plan: Plan) -> Plan:
    """Return a plan with the mandatory rules alone: the others are free to change."""
    if plan.msrcn is None:
        return plan
    rules = tuple(each for each in plan.msrcn.rules if each.mandatory)
    return replace(plan, msrcn=replace(plan.msrcn, rules=rules))


def _differences(
    current: object, new: object, changeable: Mapping[type, frozenset[str]], place: str
) -> Iterator[str]:
    if isinstance(current, tuple) and isinstance(new, tuple) and len(current) == len(new):
        for index, (one, other) in enumerate(zip(current, new, strict=True)):
            name = _name_of(one) or str(index + 1)
            yield from _differences(one, other, changeable, f"{place} {name}")
    elif is_dataclass(current) and type(current) is type(new):
        for name in _compared_fields(current, changeable):
            inner = f"{place}: {name}" if place else name
            one, other = getattr(current, name), getattr(new, name)
            yield from _differences(one, other, changeable, inner)
    elif current != new:
        yield place


def _compared_fields(part: object, changeable: Mapping[type, frozenset[str]]) -> Sequence[str]:
    free = changeable.get(type(part), frozenset())
    return [each.name for each in fields(part) if each.name not in free]  # type: ignore[arg-type]


def _name_of(part: object) -> str:
    named = ("id", "name", "topic")
    return next((str(getattr(part, key)) for key in named if hasattr(part, key)), "")

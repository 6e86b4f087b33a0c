"""`KEY=VALUE` of `rtron settings set` as the service takes it: what may be set, and how it is read.

Durations, velocities and policies stay texts: the service reads them as the plan's reader does.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from rtron.errors import InputError, suggestion

PLAN_VALUE = "plan"
"""The value that restores the plan's value."""

_Parser = Callable[[str], Any]
_BITS = {"true": True, "1": True, "false": False, "0": False}


def _text(value: str) -> str:
    return value


def _boolean(value: str) -> bool:
    if value not in _BITS:
        raise ValueError("give true or false")
    return _BITS[value]


def _integer(value: str) -> int:
    try:
        return int(value)
    except ValueError:
        raise ValueError("give a whole number") from None


def _list(value: str) -> list[str]:
    return [part.strip() for part in value.split(",") if part.strip()]


_NODE: Mapping[str, _Parser] = {
    "policy": _text,
    "release_after": _text,
    "max_age": _text,
    "max_hold": _text,
    "threshold": _text,
    "max_vel_limit": _text,
}
_FLOW: Mapping[str, _Parser] = {"priority": _integer, "block": _boolean, "timeout": _text}
_RULE: Mapping[str, _Parser] = {"selected": _boolean, "when": _text, "block": _list}
KEYS = (*_NODE, *(f"FLOW.{key}" for key in _FLOW), *(f"RULE.{key}" for key in _RULE))


def complete_setting(incomplete: str) -> list[str]:
    """Return the keys that begin so, for a shell's completion."""
    return [f"{key}=" for key in KEYS if key.startswith(incomplete)]


def parse_patch(
    assignments: Sequence[str], flows: Collection[str], *, has_rules: bool
) -> dict[str, Any]:
    """Return the change of one coordination node; a dotted name is one of `flows`, or else a rule.

    InputError for a word that is none, with the nearest key.
    """
    patch: dict[str, Any] = {}
    for assignment in assignments:
        name, separator, value = assignment.partition("=")
        if not separator:
            raise InputError(
                f"what is {assignment!r}?", help="give KEY=VALUE, for example policy=Block"
            )
        owner, _, key = name.rpartition(".")
        part, table = _section(owner, flows, has_rules=has_rules)
        target = patch.setdefault(part, {}).setdefault(owner, {}) if part else patch
        target[key] = _parse_value(assignment, value, _parser_for(key, table))
    return patch


def _section(
    owner: str, flows: Collection[str], *, has_rules: bool
) -> tuple[str, Mapping[str, _Parser]]:
    if not owner:
        return "", _NODE
    if owner in flows:
        return "flows", _FLOW
    if has_rules:
        return "rules", _RULE
    raise InputError(f"no flow is called {owner!r}", help=suggestion(owner, flows))


def _parser_for(key: str, table: Mapping[str, _Parser]) -> _Parser:
    if key not in table:
        raise InputError(f"no setting is called {key!r}", help=suggestion(key, table))
    return table[key]


def _parse_value(assignment: str, value: str, parse: _Parser) -> object:
    if value == PLAN_VALUE:
        return None
    try:
        return parse(value)
    except ValueError as error:
        raise InputError(
            f"{assignment!r}: {error}", help=f"{PLAN_VALUE} restores the plan's value"
        ) from None

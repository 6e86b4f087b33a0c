"""`KEY=VALUE` of `rtron settings set` as the service takes it: what may be set, and how it is read.

Durations, velocities and policies stay texts: the service reads them as the plan's reader does.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from rtron.errors import InputError

PLANNED = "plan"
"""The value that takes a setting back to what the plan says."""

_Read = Callable[[str], Any]
_BITS = {"true": True, "1": True, "false": False, "0": False}


def _text(value: str) -> str:
    return value


def _bit(value: str) -> bool:
    if value not in _BITS:
        raise ValueError("say true or false")
    return _BITS[value]


def _whole(value: str) -> int:
    try:
        return int(value)
    except ValueError:
        raise ValueError("say a whole number") from None


def _list(value: str) -> list[str]:
    return [part.strip() for part in value.split(",") if part.strip()]


_NODE: Mapping[str, _Read] = {
    "policy": _text,
    "release_after": _text,
    "max_age": _text,
    "max_hold": _text,
    "threshold": _text,
    "max_vel_limit": _text,
}
_FLOW: Mapping[str, _Read] = {"priority": _whole, "block": _bit, "timeout": _text}
_RULE: Mapping[str, _Read] = {"selected": _bit, "when": _text, "block": _list}
KEYS = (*_NODE, *(f"FLOW.{key}" for key in _FLOW), *(f"RULE.{key}" for key in _RULE))


def patch_of(words: Sequence[str], flows: Collection[str], *, has_rules: bool) -> dict[str, Any]:
    """Return the change of one coordination node; a dotted name is one of `flows`, or else a rule.

    InputError for a word that is none, with the nearest key.
    """
    patch: dict[str, Any] = {}
    for word in words:
        name, assigned, value = word.partition("=")
        if not assigned:
            raise InputError(f"what is {word!r}?", help="say KEY=VALUE, for example policy=Block")
        owner, _, key = name.rpartition(".")
        part, table = _part(owner, flows, has_rules=has_rules)
        place = patch.setdefault(part, {}).setdefault(owner, {}) if part else patch
        place[key] = _value(word, value, _reader(key, table))
    return patch


def _part(
    owner: str, flows: Collection[str], *, has_rules: bool
) -> tuple[str, Mapping[str, _Read]]:
    if not owner:
        return "", _NODE
    if owner in flows:
        return "flows", _FLOW
    if has_rules:
        return "rules", _RULE
    raise InputError(f"no flow is called {owner!r}", help=_near(owner, flows))


def _reader(key: str, table: Mapping[str, _Read]) -> _Read:
    if key not in table:
        raise InputError(f"no setting is called {key!r}", help=_near(key, table))
    return table[key]


def _value(word: str, value: str, read: _Read) -> object:
    if value == PLANNED:
        return None
    try:
        return read(value)
    except ValueError as error:
        raise InputError(f"{word!r}: {error}", help=f"{PLANNED} is what the plan says") from None


def _near(word: str, known: Collection[str]) -> str:
    near = get_close_matches(word, known, n=1)
    return f"did you mean {near[0]}?" if near else f"there are: {', '.join(known)}"

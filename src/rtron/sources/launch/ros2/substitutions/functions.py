"""What the substitutions do that depend on their arguments only (docs.ros.org: launch)."""

import math
import os.path
from collections.abc import Callable, Mapping
from typing import TypeAlias

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.substitutions.python_expression import python_expression
from rtron.sources.launch.ros2.substitutions.template import has_hole, shown

Function: TypeAlias = Callable[[list[str]], str]

_TRUE, _FALSE = frozenset({"true", "1"}), frozenset({"false", "0"})
_YES = _TRUE | {"yes", "on"}


class OpenError(UnresolvableError):
    """A text is needed whole of which a part is not known: why is noted where that part stands."""


def truth(text: str) -> bool:
    """Return what a condition says; raise ValueError where launch would refuse it."""
    word = closed(text).strip().lower()
    if word not in _TRUE | _FALSE:
        raise ValueError(f"'{text[:80]}' is neither true nor false")
    return word in _TRUE


def closed(text: str) -> str:
    """Return a text that is known whole; raise OpenError for another."""
    if has_hole(text):
        raise OpenError(f"'{shown(text)[:80]}' is not known whole")
    return text


def given(arguments: list[str], least: int, most: int) -> list[str]:
    """Return the arguments; raise ValueError if there are too few or too many."""
    if not least <= len(arguments) <= most:
        raise ValueError(f"{len(arguments)} arguments, expected {least} to {most}")
    return arguments


def said(value: bool) -> str:  # noqa: FBT001 - what launch writes for it
    """Return a bool as launch writes it."""
    return str(value).lower()


def _eval(arguments: list[str]) -> str:
    return python_expression(closed(given(arguments, 1, 2)[0]))


def _equal(arguments: list[str]) -> bool:
    """Compare as EqualsSubstitution does: bools and numbers by what they are."""
    left, right = map(closed, given(arguments, 2, 2))
    if {left.lower(), right.lower()} <= _TRUE | _FALSE:
        return truth(left) is truth(right)
    try:
        return math.isclose(float(left), float(right))
    except ValueError:
        return left == right


def _either(words: list[str], *, wanted: bool) -> str:
    """Return `any` (`all`), which one known argument may decide."""
    known = [truth(word) for word in words if not has_hole(word)]
    if wanted not in known and len(known) < len(words):
        closed("".join(words))
    return said(wanted if wanted in known else not wanted)


def _chosen(words: list[str]) -> str:
    condition, *values = given(words, 2, 3)
    return (*values, "")[0 if truth(condition) else 1]


PURE: Mapping[str, Function] = {
    "not": lambda words: said(not truth(*given(words, 1, 1))),
    "and": lambda words: _either(given(words, 2, 2), wanted=False),
    "or": lambda words: _either(given(words, 2, 2), wanted=True),
    "all": lambda words: _either(words, wanted=False),
    "any": lambda words: _either(words, wanted=True),
    "equals": lambda words: said(_equal(words)),
    "not-equals": lambda words: said(not _equal(words)),
    "if": _chosen,
    "eval": _eval,
    "path-join": lambda words: os.path.join(*words) if words else "",  # noqa: PTH118 - as launch
    "string-join": lambda words: words[0].join(words[1:]),
    "as-bool": lambda words: str(closed(words[0]).strip().lower() in _YES),
}

"""What the substitutions do that depend on their arguments only (docs.ros.org: launch)."""

import math
import os.path
from collections.abc import Callable, Mapping
from typing import TypeAlias

from rtron.sources.launch.ros2.conditions import FALSE, TRUE, parse_condition
from rtron.sources.launch.ros2.substitutions.python_expression import evaluate_python_expression
from rtron.sources.launch.ros2.substitutions.template import has_placeholder, require_known

Function: TypeAlias = Callable[[list[str]], str]

_TRUE_OR_YES = TRUE | {"yes", "on"}


def require_arguments(arguments: list[str], min_count: int, max_count: int) -> list[str]:
    """Return the arguments; raise ValueError if there are too few or too many."""
    if not min_count <= len(arguments) <= max_count:
        raise ValueError(f"{len(arguments)} arguments, expected {min_count} to {max_count}")
    return arguments


def format_bool(value: bool) -> str:  # noqa: FBT001 - what launch writes for it
    """Return a bool as launch writes it."""
    return str(value).lower()


def _eval(arguments: list[str]) -> str:
    return evaluate_python_expression(require_known(require_arguments(arguments, 1, 2)[0]))


def _equal(arguments: list[str]) -> bool:
    """Compare as EqualsSubstitution does: bools and numbers by what they are."""
    left, right = map(require_known, require_arguments(arguments, 2, 2))
    if {left.lower(), right.lower()} <= TRUE | FALSE:
        return parse_condition(left) is parse_condition(right)
    try:
        return math.isclose(float(left), float(right))
    except ValueError:
        return left == right


def _any_or_all(arguments: list[str], *, decisive: bool) -> str:
    """Return `any` (`all`), which one known argument may decide."""
    known = [parse_condition(argument) for argument in arguments if not has_placeholder(argument)]
    if decisive not in known and len(known) < len(arguments):
        require_known("".join(arguments))
    return format_bool(decisive if decisive in known else not decisive)


def _if_else(arguments: list[str]) -> str:
    condition, *values = require_arguments(arguments, 2, 3)
    return (*values, "")[0 if parse_condition(condition) else 1]


PURE_FUNCTIONS: Mapping[str, Function] = {
    "not": lambda words: format_bool(not parse_condition(*require_arguments(words, 1, 1))),
    "and": lambda words: _any_or_all(require_arguments(words, 2, 2), decisive=False),
    "or": lambda words: _any_or_all(require_arguments(words, 2, 2), decisive=True),
    "all": lambda words: _any_or_all(words, decisive=False),
    "any": lambda words: _any_or_all(words, decisive=True),
    "equals": lambda words: format_bool(_equal(words)),
    "not-equals": lambda words: format_bool(not _equal(words)),
    "if": _if_else,
    "eval": _eval,
    "path-join": lambda words: os.path.join(*words) if words else "",  # noqa: PTH118 - as launch
    "string-join": lambda words: words[0].join(words[1:]),
    "as-bool": lambda words: str(require_known(words[0]).strip().lower() in _TRUE_OR_YES),
}

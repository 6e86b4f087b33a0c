"""What the substitutions do that depend on their arguments only (docs.ros.org: launch).

In XML and YAML the children run once for each round; `$(for-var name)` and `$(index name)` give the
values of the round. In Python a function does.
"""

import math
import os.path
from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.yaml_tree import plain_value
from rtron.sources.launch.ros2.choices import FALSE, TRUE, parse_condition
from rtron.sources.launch.ros2.parameters.file import parse_yaml_tree
from rtron.sources.launch.ros2.substitutions.python_expression import evaluate_python_expression
from rtron.sources.launch.ros2.substitutions.template import has_placeholder, require_known
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

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


MAX_ITERATIONS = 128
Row: TypeAlias = dict[str, object]
Iteration: TypeAlias = Mapping[str, str | None]
LOOPS = {"for": "len", "for_each": "values"}
"""The loops of XML and YAML, and the attribute that says how often each runs."""
UNKNOWN_ITERATION: Iteration = {UNKNOWN_NAME: None}
"""A round of a loop of which nothing is known."""
UNKNOWN_COUNT = "how often it runs is not known, it is read as if once"


def parse_rows(text: str) -> list[Row] | None:
    """Return the rows that a text says, `{a: 1};{a: 2}`; None where it is not known whole."""
    if has_placeholder(text):
        return None
    rows = [
        plain_value(parse_yaml_tree(row, ""))
        for row in text.split(";")[:MAX_ITERATIONS]
        if row.strip()
    ]
    return [{str(k): v for k, v in row.items()} if isinstance(row, dict) else {} for row in rows]


def parse_count(text: str) -> list[int] | None:
    """Return the numbers up to the one that a text says; None where it is not known."""
    is_number = not has_placeholder(text) and text.strip().isdecimal()
    return list(range(min(int(text), MAX_ITERATIONS))) if is_number else None


def iterations_of(tag: str, name: str, text: str) -> list[Iteration] | None:
    """Return the values in each round of a loop of XML or YAML; None where they are not known."""
    numbers = parse_count(text) if tag == "for" else None
    rows = [{name: n} for n in numbers] if numbers is not None else None
    rows_of_values: Sequence[Mapping[str, object]] | None = (
        rows if tag == "for" else parse_rows(text)
    )
    if rows_of_values is None:
        return None
    return [{key: str(value) for key, value in row.items()} for row in rows_of_values]


def loop_variable(values: Mapping[str, str | None]) -> Function:
    """Return what `$(for-var name default)` does; a value of None is one that is not known."""

    def found(arguments: list[str]) -> str:
        name, *default = require_arguments(arguments, 1, 2)
        value = values.get(name, values.get(UNKNOWN_NAME, default[0] if default else ""))
        if value is None:
            raise UnresolvableError(f"the value of '{name}' is not known")
        if name not in values and not default:
            raise UnresolvableError(f"no loop around it has '{name}'")
        return value

    return found

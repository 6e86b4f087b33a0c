"""The loops of launch: `for_each` over rows of values, `for` over numbers (docs.ros.org: launch).

In XML and YAML the children run once for each round; `$(for-var name)` and `$(index name)` give the
values of the round. In Python a function does.
"""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.yaml_tree import plain_value
from rtron.sources.launch.ros2.parameters.file import parse_yaml_tree
from rtron.sources.launch.ros2.substitutions.functions import Function, require_arguments
from rtron.sources.launch.ros2.substitutions.template import has_placeholder
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

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

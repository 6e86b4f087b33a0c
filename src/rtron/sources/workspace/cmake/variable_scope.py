"""What loops, macros and functions of a CMake file give their variables."""

from collections.abc import Mapping, Sequence
from itertools import zip_longest

from rtron.sources.workspace.cmake.command_call import (
    ExpandedArgument,
    VariableScope,
    VariableValue,
    split_list,
)

_NUMBERED = 10
_MOST_NUMBERED = 32
_LOOP_WORDS = frozenset({"LISTS", "ITEMS", "ZIP_LISTS"})


def loop_rounds(
    given: Sequence[ExpandedArgument], scope: VariableScope
) -> list[dict[str, VariableValue]]:
    """Return the variables of each round of a foreach(): of ZIP_LISTS one for each list."""
    words = [item.text for item in given]
    if "ZIP_LISTS" not in words:
        name = words[0] if words else ""
        items = loop_items(given[1:], scope)
        return [{name: VariableValue(item.text, item.known)} for item in items]
    start = words.index("ZIP_LISTS")
    names, lists = words[: start - 1], [_list_variable(name, scope) for name in words[start + 1 :]]
    if len(names) == 1:
        names = [f"{names[0]}_{number}" for number in range(len(lists))]
    known = all(value.known for value in lists)
    rounds = zip_longest(*(split_list(value.text) for value in lists), fillvalue="")
    return [
        {name: VariableValue(text, known) for name, text in zip(names, texts, strict=False)}
        for texts in rounds
    ]


def is_loop_unknown(given: Sequence[ExpandedArgument], scope: VariableScope) -> bool:
    """Tell whether some of what a foreach() goes through stands in a variable without a value."""
    words = [item.text for item in given]
    lists = words[words.index("IN") + 1 :] if "IN" in words else []
    unknown = (not _list_variable(word, scope).known for word in lists if word not in _LOOP_WORDS)
    return not all(item.known for item in given) or any(unknown)


def _list_variable(name: str, scope: VariableScope) -> VariableValue:
    return scope.variables.get(name, VariableValue("", known=False))


def loop_items(given: Sequence[ExpandedArgument], scope: VariableScope) -> list[ExpandedArgument]:
    """Return what a foreach() goes through: elements, lists and their names, or a range."""
    words = [item.text for item in given]
    if words[:1] == ["RANGE"]:
        numbers = [int(word) for word in words[1:4] if word.isdecimal() and len(word) < 6]  # noqa: PLR2004
        return [ExpandedArgument(text=str(number)) for number in _loop_range(numbers)]
    if words[:1] != ["IN"]:
        return [item for item in given if item.text]
    found: list[ExpandedArgument] = []
    kind = ""
    for item in given[1:]:
        if item.text in {"LISTS", "ITEMS"}:
            kind = item.text
        elif kind == "LISTS":
            value = _list_variable(item.text, scope)
            found.extend(
                ExpandedArgument(text=text, known=value.known) for text in split_list(value.text)
            )
        else:
            found.append(item)
    return found


def _loop_range(numbers: Sequence[int]) -> range:
    start = numbers[0] if len(numbers) > 1 else 0
    stop = numbers[min(1, len(numbers) - 1)] + 1 if numbers else 0
    return range(start, stop, max(1, numbers[2]) if numbers[2:] else 1)


def argument_variables(
    names: Sequence[str], given: Sequence[ExpandedArgument]
) -> dict[str, VariableValue]:
    """Return the variables that the arguments of a macro or function become.

    `ARGV3` and the like are empty where there are fewer arguments.
    """
    values = [VariableValue(item.text, item.known) for item in given]
    rest = values[len(names) :]
    return {
        **{f"ARGV{index}": VariableValue("") for index in range(len(values), _NUMBERED)},
        **{f"ARGV{index}": value for index, value in enumerate(values[:_MOST_NUMBERED])},
        **dict(zip(names, values, strict=False)),
        "ARGC": VariableValue(str(len(values))),
        "ARGV": _joined_value(values),
        "ARGN": _joined_value(rest),
    }


def _joined_value(values: Sequence[VariableValue]) -> VariableValue:
    return VariableValue(
        ";".join(value.text for value in values), all(value.known for value in values)
    )


def restore_variables(scope: VariableScope, before: Mapping[str, VariableValue | None]) -> None:
    """Give variables the values that they had before; None: they had none."""
    for name, value in before.items():
        if value is None:
            scope.variables.pop(name, None)
        else:
            scope.variables[name] = value


def join_variables(results: Sequence[Mapping[str, VariableValue]]) -> dict[str, VariableValue]:
    """Return the variables after a choice: where the branches differ, all their elements."""
    first, *others = results
    joined = dict(first)
    for other in others:
        for name, value in other.items():
            old = joined.get(name)
            if old is not value:
                joined[name] = _join_values(old, value)
        for name in joined.keys() - other.keys():
            joined[name] = VariableValue(joined[name].text, known=False)
    return joined


def _join_values(old: VariableValue | None, new: VariableValue) -> VariableValue:
    if old == new:
        return new
    elements = dict.fromkeys((*(split_list(old.text) if old else ()), *split_list(new.text)))
    return VariableValue(";".join(elements), known=False)

"""What loops, macros and functions of a CMake file give their variables."""

from collections.abc import Mapping, Sequence

from rtron.sources.workspace.cmake.command_call import VariableScope
from rtron.sources.workspace.cmake.values import ExpandedArgument, VariableValue, split_list


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
            value = scope.variables.get(item.text, VariableValue("", known=False))
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
    """Return the variables that the arguments of a macro or function become."""
    values = [VariableValue(item.text, item.known) for item in given]
    rest = values[len(names) :]
    return {
        **{f"ARGV{index}": value for index, value in enumerate(values[:32])},
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

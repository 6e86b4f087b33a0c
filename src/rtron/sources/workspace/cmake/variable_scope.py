"""What loops, macros and functions of a CMake file give their variables."""

from collections.abc import Mapping, Sequence

from rtron.sources.workspace.cmake.command_call import Scope
from rtron.sources.workspace.cmake.values import Item, Value, split


def loop_values(given: Sequence[Item], scope: Scope) -> list[Item]:
    """Return what a foreach() goes through: elements, lists and their names, or a range."""
    words = [item.text for item in given]
    if words[:1] == ["RANGE"]:
        numbers = [int(word) for word in words[1:4] if word.isdecimal() and len(word) < 6]  # noqa: PLR2004
        return [Item(text=str(number)) for number in _range(numbers)]
    if words[:1] != ["IN"]:
        return [item for item in given if item.text]
    found: list[Item] = []
    kind = ""
    for item in given[1:]:
        if item.text in {"LISTS", "ITEMS"}:
            kind = item.text
        elif kind == "LISTS":
            value = scope.variables.get(item.text, Value("", known=False))
            found.extend(Item(text=text, known=value.known) for text in split(value.text))
        else:
            found.append(item)
    return found


def _range(numbers: Sequence[int]) -> range:
    start = numbers[0] if len(numbers) > 1 else 0
    stop = numbers[min(1, len(numbers) - 1)] + 1 if numbers else 0
    return range(start, stop, max(1, numbers[2]) if numbers[2:] else 1)


def bound(names: Sequence[str], given: Sequence[Item]) -> dict[str, Value]:
    """Return the variables that the arguments of a macro or function become."""
    values = [Value(item.text, item.known) for item in given]
    rest = values[len(names) :]
    return {
        **{f"ARGV{place}": value for place, value in enumerate(values[:32])},
        **dict(zip(names, values, strict=False)),
        "ARGC": Value(str(len(values))),
        "ARGV": _listed(values),
        "ARGN": _listed(rest),
    }


def _listed(values: Sequence[Value]) -> Value:
    return Value(";".join(value.text for value in values), all(value.known for value in values))


def restore(scope: Scope, before: Mapping[str, Value | None]) -> None:
    """Give variables the values that they had before; None: they had none."""
    for name, value in before.items():
        if value is None:
            scope.variables.pop(name, None)
        else:
            scope.variables[name] = value

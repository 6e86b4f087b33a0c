"""The arguments of a function by their keywords (CMake's manual, cmake_parse_arguments)."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from rtron.sources.workspace.cmake.command_call import CommandCall, VariableScope
from rtron.sources.workspace.cmake.values import ExpandedArgument, VariableValue, split_list
from rtron.sources.workspace.cmake.variables import Handler

_HEAD_LENGTH = 4
"""The prefix, and the options, keywords of one value and keywords of several."""


@dataclass(slots=True)
class _KeywordArguments:
    """What stands behind each keyword, and what behind none."""

    options: dict[str, bool]
    one: dict[str, ExpandedArgument | None]
    several: dict[str, list[ExpandedArgument]]
    rest: list[ExpandedArgument] = field(default_factory=list)

    def read(self, items: Iterable[ExpandedArgument]) -> None:
        """Take the arguments; one for a single value that has its value is behind none."""
        current = ""
        for item in items:
            if item.text in self.options:
                self.options[item.text] = True
                current = ""
            elif item.text in self.one or item.text in self.several:
                current = item.text
            elif current in self.several:
                self.several[current].append(item)
            elif current:
                self.one[current] = item
                current = ""
            else:
                self.rest.append(item)


def parse_arguments(call: CommandCall) -> None:
    """Carry out `cmake_parse_arguments`, also in its form for the caller's own arguments."""
    own = call.items[:1] and call.items[0].text == "PARSE_ARGV"
    head = call.items[2:] if own else call.items
    if len(head) < _HEAD_LENGTH:
        return
    given = _caller_arguments(call) if own else head[_HEAD_LENGTH:]
    options, one, several = (split_list(item.text) for item in head[1:_HEAD_LENGTH])
    parsed = _KeywordArguments(
        dict.fromkeys(options, False), dict.fromkeys(one), {w: [] for w in several}
    )
    parsed.read(given)
    for name, (text, known) in _result_variables(parsed, _known_arguments(call.scope)).items():
        call.set(f"{head[0].text}_{name}", text, known=known)


def _result_variables(
    parsed: _KeywordArguments, known_arguments: Mapping[str, bool]
) -> dict[str, tuple[str, bool]]:
    lists = {**parsed.several, "UNPARSED_ARGUMENTS": parsed.rest}
    lists.update((name, [item] if item else []) for name, item in parsed.one.items())
    flags = {name: (str(found).upper(), True) for name, found in parsed.options.items()}
    return {
        **flags,
        **{name: _joined_items(items, known_arguments) for name, items in lists.items()},
    }


def _joined_items(
    items: Sequence[ExpandedArgument], known_arguments: Mapping[str, bool]
) -> tuple[str, bool]:
    known = all(item.known or known_arguments.get(item.text, False) for item in items)
    return ";".join(item.text for item in items), known


def _known_arguments(scope: VariableScope) -> dict[str, bool]:
    """Return which arguments are known by themselves: of the list of all only all may be."""
    values = (scope.lookup(f"ARGV{index}") for index in range(32))
    return {value.text: value.known for value in values if value is not None}


def _caller_arguments(call: CommandCall) -> list[ExpandedArgument]:
    """Return the caller's own arguments, from the given index on."""
    start = call.items[1].text if call.items[1:] else ""
    value = call.scope.variables.get("ARGV", VariableValue(""))
    found = [ExpandedArgument(text=text, known=value.known) for text in split_list(value.text)]
    return found[int(start) :] if start.isdecimal() and len(start) < 3 else found  # noqa: PLR2004


PARSING_COMMANDS: Mapping[str, Handler] = {"cmake_parse_arguments": parse_arguments}

"""Values of CMake variables, and the arguments of a command with all `${…}` replaced."""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.workspace.cmake.tokenizer import CommandArgument

MAX_LENGTH = 256 * 1024

_PIECE = re.compile(r"\$(?:ENV|CACHE)?\{|\}|\\.|[^$}\\]+|[$\\]", re.DOTALL)
_SEPARATOR = re.compile(r"(?<!\\);")
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", ";": "\\;"}


class BoundsError(Exception):
    """The evaluation has taken too many steps, or a value became too long."""


@dataclass(frozen=True, slots=True)
class VariableValue:
    """A value; `known` says that a build has this one and no other. A list is joined by `;`."""

    text: str
    known: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpandedArgument:
    """An argument as a command gets it; `expanded` says that a variable stood in it."""

    text: str
    known: bool = True
    quoted: bool = False
    expanded: bool = False


Lookup: TypeAlias = Callable[[str], VariableValue | None]


def expand_arguments(
    arguments: Iterable[CommandArgument], lookup: Lookup
) -> list[ExpandedArgument]:
    """Return what a command gets; raise BoundsError where that is too long."""
    return [item for argument in arguments for item in _expand_argument(argument, lookup)]


def split_list(text: str) -> list[str]:
    """Return the elements of a list, the empty ones left out."""
    return [part.replace("\\;", ";") for part in _SEPARATOR.split(text) if part]


def expand_variables(text: str, lookup: Lookup) -> VariableValue:
    """Return a text with its `${…}` replaced, inner ones first; what is not set is unknown."""
    open_names: list[tuple[str, list[str]]] = [("", [])]
    known, length = True, 0
    for match in _PIECE.finditer(text):
        piece = match[0]
        if piece.endswith("{") and piece.startswith("$"):
            open_names.append((piece, []))
            continue
        if piece == "}" and len(open_names) > 1:
            sign, parts = open_names.pop()
            value = lookup("".join(parts)) if sign == "${" else None
            known = known and value is not None and value.known
            piece = value.text if value else ""
        elif len(piece) > 1 and piece.startswith("\\"):
            piece = _ESCAPES.get(piece[1], piece[1])
        length += len(piece)
        if length > MAX_LENGTH:
            raise BoundsError("a value becomes too long")
        open_names[-1][1].append(piece)
    return VariableValue("".join(sign + "".join(parts) for sign, parts in open_names), known)


def _expand_argument(argument: CommandArgument, lookup: Lookup) -> Iterator[ExpandedArgument]:
    if argument.raw:
        yield ExpandedArgument(text=argument.text, quoted=True)
        return
    value = expand_variables(argument.text, lookup)
    expanded = "$" in argument.text
    if argument.quoted:
        yield ExpandedArgument(text=value.text, known=value.known, quoted=True, expanded=expanded)
        return
    parts = split_list(value.text)
    for text in parts if parts or value.known else [""]:
        yield ExpandedArgument(text=text, known=value.known, expanded=expanded)

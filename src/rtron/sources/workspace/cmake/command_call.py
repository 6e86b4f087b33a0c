"""One call of a CMake command, with its arguments expanded in the scope of its variables."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from rtron.sources.workspace.cmake.build import PackageBuild
from rtron.sources.workspace.cmake.tokenizer import CommandArgument
from rtron.vocabulary import Evidence

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


MAX_STEPS = 200_000


@dataclass(slots=True, kw_only=True)
class VariableScope:
    """Variables of a folder or function; `parent` gets what is set with PARENT_SCOPE.

    `arguments` are those of the macro that is carried out: they stand for its parameters in its
    text, and are no variables.
    """

    folder: Path
    variables: dict[str, VariableValue] = field(default_factory=dict)
    parent: "VariableScope | None" = None
    arguments: Mapping[str, VariableValue] = field(default_factory=dict)

    def lookup(self, name: str) -> VariableValue | None:
        """Return what `${name}` stands for."""
        return self.arguments.get(name) or self.variables.get(name)

    def set(self, name: str, value: VariableValue) -> None:
        """Set a variable."""
        self.variables[name] = value

    def child(self, folder: Path) -> "VariableScope":
        """Return a scope that begins as a copy of this one."""
        here = {"CMAKE_CURRENT_SOURCE_DIR": VariableValue(str(folder))}
        return VariableScope(folder=folder, variables={**self.variables, **here}, parent=self)


@dataclass(slots=True)
class StepBudget:
    """The steps that an evaluation may still take; a step handles some hundred characters."""

    left: int = MAX_STEPS

    def spend(self, size: int = 0) -> None:
        """Take a step for something of a size; raise BoundsError where none is left."""
        self.left -= 1 + size // 256
        if self.left < 0:
            raise BoundsError("takes too many steps")


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandCall:
    """A command with its arguments replaced."""

    name: str
    items: tuple[ExpandedArgument, ...]
    scope: VariableScope
    build: PackageBuild
    budget: StepBudget
    evidence: Evidence

    @property
    def words(self) -> list[str]:
        """The arguments as text, empty ones left out."""
        return [item.text for item in self.items if item.text]

    def set(self, name: str, text: str, *, known: bool = True) -> None:
        """Set a variable in the scope of the command."""
        self.budget.spend(len(text))
        self.scope.set(name, VariableValue(text, known))

    def add_unresolved(self, what: str, why: str) -> None:
        """Note what of the command could not be resolved."""
        self.build.add_unresolved(what, why, self.evidence)


def split_by_keyword(words: list[str], keywords: frozenset[str]) -> Mapping[str, list[str]]:
    """Return what follows each keyword, and under "" what comes before the first."""
    found: dict[str, list[str]] = {"": []}
    current = found[""]
    for word in words:
        if word in keywords:
            current = found.setdefault(word, [])
        else:
            current.append(word)
    return found

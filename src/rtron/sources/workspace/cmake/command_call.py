"""A command as it is carried out, and where."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.sources.workspace.cmake.build import PackageBuild
from rtron.sources.workspace.cmake.values import BoundsError, ExpandedArgument, VariableValue
from rtron.vocabulary import Evidence

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

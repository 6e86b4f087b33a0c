"""The text of one launch file of ROS 2 with small changes; the rest of it stays as it was."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

RemapPair: TypeAlias = tuple[str, str]
"""A remap: from, to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardedFolder:
    """The folder of the guarded launch's files, and the configuration that is to hold it."""

    folder: str
    variable: str

    def __truediv__(self, name: str) -> str:
        """Return the path of one of the files."""
        return f"$(var {self.variable})/{name}"


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardStart:
    """What comes first in a guarded launch: variables, the file `check`, and the guard's `script`.

    The script is started again when it ends. Every other process starts through `prefix`, if any.
    """

    script: str
    name: str
    check: str
    environment: Mapping[str, str] = field(default_factory=dict)
    prefix: str = ""


PREFIX = "launch-prefix"
"""The configuration, and the attribute of a process, that stands before its command (launch)."""


class LaunchFileText(Protocol):
    """What can be changed; `index` is where an element stands, as LaunchNode.element says it."""

    def add_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put remaps before a node's own."""

    def add_early_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put remaps before those of a process' arguments and of `set_remap`."""

    def is_component(self, index: int) -> bool:
        """Tell whether a node is a component, which has no arguments."""

    def start_through(self, index: int, prefix: str, name: str) -> None:
        """Put a prefix before a process's own; it keeps its `name` in the log."""

    def redirect_include(self, index: int, file: str) -> None:
        """Lead an include to another file."""

    def add_guard(self, folder: GuardedFolder, guard: GuardStart) -> None:
        """Set the guard's variables and include `check` first; then start its script."""

    def render(self) -> str:
        """Return the text with all changes made."""


def prepend_remaps(rules: Sequence[RemapPair], args: str) -> str:
    """Return a process' arguments with remaps in front, which count before all others."""
    remaps = " ".join(f"-r {source}:={target}" for source, target in rules)
    return f"--ros-args {remaps} -- {args}".rstrip()

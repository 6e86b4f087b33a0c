"""The text of one launch file of ROS 2 with small changes; the rest of it stays as it was."""

from collections.abc import Sequence
from dataclasses import dataclass
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


class LaunchFileText(Protocol):
    """What can be changed; `index` is where an element stands, as LaunchNode.element says it."""

    def add_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put remaps before a node's own."""

    def add_early_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put remaps before those of a process' arguments and of `set_remap`."""

    def is_component(self, index: int) -> bool:
        """Tell whether a node is a component, which has no arguments."""

    def redirect_include(self, index: int, file: str) -> None:
        """Lead an include to another file."""

    def add_guard(self, folder: "GuardedFolder", *, script: str, name: str, check: str) -> None:
        """Include the file `check` first; then start `script`, and again when it ends."""

    def render(self) -> str:
        """Return the text with all changes made."""


def prepend_remaps(rules: Sequence[RemapPair], args: str) -> str:
    """Return a process' arguments with remaps in front, which count before all others."""
    remaps = " ".join(f"-r {source}:={target}" for source, target in rules)
    return f"--ros-args {remaps} -- {args}".rstrip()

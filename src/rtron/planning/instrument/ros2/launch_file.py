"""The text of one launch file of ROS 2 with small changes; the rest of it stays as it was."""

from collections.abc import Sequence
from typing import Protocol, TypeAlias

Rule: TypeAlias = tuple[str, str]
"""A remap: from, to."""


class LaunchFileText(Protocol):
    """What can be changed; `place` is where an element stands, as LaunchNode.element says it."""

    def own_rules(self, place: int) -> int:
        """Return how many remaps a node has as parts of its own."""

    def remap(self, place: int, rules: Sequence[Rule]) -> None:
        """Put remaps before a node's own."""

    def remap_early(self, place: int, rules: Sequence[Rule]) -> None:
        """Put remaps before those of a process' arguments and of `set_remap`."""

    def loads(self, place: int) -> bool:
        """Tell whether a node is a component, which has no arguments."""

    def lead(self, place: int, file: str) -> None:
        """Lead an include to another file."""

    def start(self, command: str, name: str) -> None:
        """Start a command first, and again when it ends."""

    def changed(self) -> str:
        """Return the text with all changes made."""


def early(rules: Sequence[Rule], args: str) -> str:
    """Return a process' arguments with remaps in front, which count before all others."""
    words = " ".join(f"-r {source}:={target}" for source, target in rules)
    return f"--ros-args {words} -- {args}".rstrip()

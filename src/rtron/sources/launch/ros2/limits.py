"""How large a launch may be. Reading ends at what no app has, so that no file can keep it busy."""

from dataclasses import dataclass

from rtron.errors import InputError
from rtron.sources.launch.ros2.launch_context import Scope

MAX_FILES = 500
MAX_INCLUDED = 32
MAX_BYTES = 16 * 1024 * 1024
MAX_LEVELS = 100
MAX_ACTIONS = 50_000
MAX_NODES = 2_000
MAX_NAMES = 2_000
MAX_RULES = 200
MAX_STEPS = 3_000_000
MAX_PIECES = 1_000_000
MAX_VALUES = 2_000_000


class TooMuchError(InputError):
    """A launch that is larger than any app's."""


@dataclass(slots=True)
class Bounds:
    """Counts what was read; each method raises TooMuchError, with the file, if it is too much."""

    files: int = 0
    bytes: int = 0
    level: int = 0
    actions: int = 0
    nodes: int = 0
    steps: int = 0
    pieces: int = 0
    values: int = 0

    def file(self, path: str) -> None:
        """Count an inclusion of a file."""
        self.files += 1
        _check(self.files, MAX_FILES, "files, or one that includes itself", path)

    def size(self, path: str, size: int) -> None:
        """Count the bytes of an inclusion."""
        self.bytes += size
        _check(self.bytes, MAX_BYTES, "bytes in all files", path)

    def deeper(self, path: str) -> None:
        """Count a level of groups and files; `level` goes back when it is left."""
        self.level += 1
        _check(self.level, MAX_LEVELS, "levels of groups and files", path)

    def action(self, path: str, scope: Scope) -> None:
        """Count an action, or a part of one, and look at what it finds."""
        self.actions += 1
        _check(self.actions, MAX_ACTIONS, "actions", path)
        _check(len(scope.remaps or ()), MAX_RULES, "shared remaps", path)
        _check(scope.size, MAX_NAMES, "configurations and variables", path)

    def node(self, path: str) -> None:
        """Count a node."""
        self.nodes += 1
        _check(self.nodes, MAX_NODES, "nodes", path)

    def step(self, path: str, steps: int) -> None:
        """Count what a Python launch file took to describe what it does."""
        self.steps += steps
        _check(self.steps, MAX_STEPS, "steps of Python", path)

    def piece(self, path: str) -> None:
        """Count a part of a text, a list or a dict that a Python launch file made."""
        self.pieces += 1
        _check(self.pieces, MAX_PIECES, "parts of texts and lists", path)

    def value(self, path: str, count: int) -> None:
        """Count the values of parameters that are kept."""
        self.values += count
        _check(self.values, MAX_VALUES, "values of parameters", path)


def _check(number: int, most: int, what: str, path: str) -> None:
    if number > most:
        raise TooMuchError(f"more than {most} {what}", path=path)

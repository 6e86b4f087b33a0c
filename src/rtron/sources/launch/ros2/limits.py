"""How large a launch may be. Reading ends at what no app has, so that no file can keep it busy."""

from dataclasses import dataclass

from rtron.errors import InputError
from rtron.sources.launch.ros2.launch_context import LaunchContext

MAX_FILES = 500
MAX_INCLUDE_DEPTH = 32
MAX_BYTES = 16 * 1024 * 1024
MAX_LEVELS = 100
MAX_ACTIONS = 50_000
MAX_NODES = 2_000
MAX_NAMES = 2_000
MAX_REMAPS = 200
MAX_STEPS = 3_000_000
MAX_TEXT_PARTS = 1_000_000
MAX_VALUES = 2_000_000


class LaunchTooLargeError(InputError):
    """A launch that is larger than any app's."""


@dataclass(slots=True)
class LaunchLimits:
    """Counts what was read.

    Each method raises LaunchTooLargeError, with the file, if it is too much.
    """

    files: int = 0
    bytes: int = 0
    level: int = 0
    actions: int = 0
    nodes: int = 0
    steps: int = 0
    text_parts: int = 0
    values: int = 0

    def count_file(self, path: str) -> None:
        """Count an inclusion of a file."""
        self.files += 1
        _check(self.files, MAX_FILES, "files, or one that includes itself", path)

    def count_bytes(self, path: str, size: int) -> None:
        """Count the bytes of an inclusion."""
        self.bytes += size
        _check(self.bytes, MAX_BYTES, "bytes in all files", path)

    def enter_level(self, path: str) -> None:
        """Count a level of groups and files; `level` goes back when it is left."""
        self.level += 1
        _check(self.level, MAX_LEVELS, "levels of groups and files", path)

    def count_action(self, path: str, context: LaunchContext) -> None:
        """Count an action, or a part of one, and look at what it finds."""
        self.actions += 1
        _check(self.actions, MAX_ACTIONS, "actions", path)
        _check(len(context.remaps or ()), MAX_REMAPS, "shared remaps", path)
        _check(context.size, MAX_NAMES, "configurations and variables", path)

    def count_node(self, path: str) -> None:
        """Count a node."""
        self.nodes += 1
        _check(self.nodes, MAX_NODES, "nodes", path)

    def count_steps(self, path: str, steps: int) -> None:
        """Count what a Python launch file took to describe what it does."""
        self.steps += steps
        _check(self.steps, MAX_STEPS, "steps of Python", path)

    def count_text_part(self, path: str) -> None:
        """Count a part of a text, a list or a dict that a Python launch file made."""
        self.text_parts += 1
        _check(self.text_parts, MAX_TEXT_PARTS, "parts of texts and lists", path)

    def count_values(self, path: str, count: int) -> None:
        """Count the values of parameters that are kept."""
        self.values += count
        _check(self.values, MAX_VALUES, "values of parameters", path)


def _check(number: int, limit: int, what: str, path: str) -> None:
    if number > limit:
        raise LaunchTooLargeError(f"more than {limit} {what}", path=path)

"""What could not be read and was left out; the rest counts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ParamSpec, TypeAlias, TypeVar

from rtron.errors import InputError

MAX_SKIPPED = 1000
P = ParamSpec("P")
T = TypeVar("T")


class UnreadableEntryError(Exception):
    """An entry is not what it should be; it is left out. `line` counts from 1, 0 if unknown."""

    def __init__(self, reason: str, *, line: int = 0) -> None:
        super().__init__(reason)
        self.line = line


@dataclass(frozen=True, slots=True, kw_only=True)
class SkippedEntry:
    """A line, file or entry that was left out: where it stands, and why."""

    location: str
    reason: str

    def __str__(self) -> str:
        return f"{self.location}: {self.reason}"


SkippedHandler: TypeAlias = Callable[[SkippedEntry], None]
"""Takes what was left out."""


def read_or_skip(
    on_skipped: SkippedHandler,
    location: str,
    read: Callable[P, T],
    *arguments: P.args,
    **keys: P.kwargs,
) -> T | None:
    """Return what `read` makes of an entry; None, and a call of `on_skipped`, if unreadable."""
    try:
        return read(*arguments, **keys)
    except UnreadableEntryError as error:
        on_skipped(
            SkippedEntry(
                location=f"{location}:{error.line}" if error.line else location, reason=str(error)
            )
        )
        return None


@dataclass(slots=True)
class SkippedCounter:
    """A Note that remembers the first and hands all on; past MAX_SKIPPED it raises InputError."""

    on_skipped: SkippedHandler
    first: SkippedEntry | None = None
    count: int = 0

    def __call__(self, skipped: SkippedEntry) -> None:
        """Take what was left out."""
        self.first = self.first or skipped
        self.count += 1
        if self.count > MAX_SKIPPED:
            help = f"is it the right file? {self.first}"
            raise InputError(f"more than {MAX_SKIPPED} entries cannot be read", help=help)
        self.on_skipped(skipped)

"""What could not be read and was left out; the rest counts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ParamSpec, TypeAlias, TypeVar

from rtron.errors import InputError

MAX_SKIPPED = 1000
P = ParamSpec("P")
T = TypeVar("T")


class UnreadableError(Exception):
    """An entry is not what it should be; it is left out. `line` counts from 1, 0 if unknown."""

    def __init__(self, why: str, *, line: int = 0) -> None:
        super().__init__(why)
        self.line = line


@dataclass(frozen=True, slots=True, kw_only=True)
class Skipped:
    """A line, file or entry that was left out: where it stands, and why."""

    place: str
    why: str

    def __str__(self) -> str:
        return f"{self.place}: {self.why}"


Note: TypeAlias = Callable[[Skipped], None]
"""Takes what was left out."""


def kept(
    note: Note, place: str, read: Callable[P, T], *arguments: P.args, **keys: P.kwargs
) -> T | None:
    """Return what `read` makes of an entry, None where it is unreadable: that goes to `note`."""
    try:
        return read(*arguments, **keys)
    except UnreadableError as error:
        note(Skipped(place=f"{place}:{error.line}" if error.line else place, why=str(error)))
        return None


@dataclass(slots=True)
class Noting:
    """A Note that remembers the first and hands all on; past MAX_SKIPPED it raises InputError."""

    note: Note
    first: Skipped | None = None
    count: int = 0

    def __call__(self, skipped: Skipped) -> None:
        """Take what was left out."""
        self.first = self.first or skipped
        self.count += 1
        if self.count > MAX_SKIPPED:
            help = f"is it the right file? {self.first}"
            raise InputError(f"more than {MAX_SKIPPED} entries cannot be read", help=help)
        self.note(skipped)

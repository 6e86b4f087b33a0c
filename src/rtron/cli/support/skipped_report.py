"""The items that a command skipped, on standard error."""

from contextlib import contextmanager
from typing import TYPE_CHECKING

from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.functions.reading import SkippedEntry, SkippedHandler

_MAX_SHOWN = 10
_MAX_LENGTH = 300


@contextmanager
def report_skipped() -> "Iterator[SkippedHandler]":
    """Yield a handler of skipped items; the first are listed at the end, also before an error."""
    rows: list[str] = []
    count = 0

    def take(skipped: "SkippedEntry") -> None:
        nonlocal count
        count += 1
        if count <= _MAX_SHOWN:
            rows.append(f"left out: {sanitize(str(skipped))[:_MAX_LENGTH]}")

    try:
        yield take
    finally:
        if count > len(rows):
            rows.append(f"left out: {count - len(rows)} more")
        print_to_stderr(*rows)


def print_to_stderr(*rows: str) -> None:
    """Print lines on standard error, beside the result."""
    from rich.console import Console
    from rich.text import Text

    if rows:
        Console(stderr=True, highlight=False).print(Text("\n".join(rows)), soft_wrap=True)

"""What the commands about repositories share: their options, and what was left out."""

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.text import Text

from rtron.reports.sanitize import sanitize

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.functions.reading import SkippedEntry, SkippedHandler

Readmes = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.jsonl", help="A line `{repo, readme}` for repositories without a README."
    ),
]
_MAX_SHOWN = 10
_MAX_LENGTH = 300


@contextmanager
def report_skipped() -> "Iterator[SkippedHandler]":
    """Yield what takes what was left out; the first of it stands on standard error at the end.

    It stands there before an error, too.
    """
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
    """Say something on standard error, beside the result."""
    if rows:
        Console(stderr=True, highlight=False).print(Text("\n".join(rows)), soft_wrap=True)

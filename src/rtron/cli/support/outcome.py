"""What a command has to say: printed here and nowhere else, with the exit code."""

from __future__ import annotations

import json
import logging
import os
import select
import sys
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from rtron.errors import InputError, RTronError
from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import TextIO

    from rich.console import Console
    from rich.markdown import Markdown

    from rtron.reports.text_layout import Report


OK, FINDINGS, BAD_INPUT = 0, 1, 2
INTERRUPTED = 130
"""128 and the number of SIGINT, as shells have it."""
STDOUT = Path("-")
STANDARD_OUTPUTS = (1, 2)
"""The numbers of standard output and standard error."""
_FILE_WIDTH = 100


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a command prints, or writes to the file `to`, and the exit code it ends with."""

    shown: str | Report | Markdown
    exit_code: int = OK
    to: Path = STDOUT


def as_json(document: Mapping[str, object]) -> str:
    """Return a document as JSON text; what is not ASCII is escaped, so a terminal is safe."""
    return json.dumps(document, indent=2) + "\n"


def deliver(outcome: Outcome, **_: object) -> None:
    """Print or write what a command found and end with its exit code."""
    if outcome.to == STDOUT:
        _print(outcome.shown)
    else:
        from rich.console import Console

        page = Console(file=StringIO(), width=_FILE_WIDTH, force_terminal=False, color_system=None)
        write_file(outcome.to, _render(outcome.shown, page))
    raise typer.Exit(outcome.exit_code)


def write_file(path: Path, text: str) -> None:
    """Write a file whole; raise InputError if that is not possible."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise _write_error(error, str(path)) from None


def write_files(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files into a folder; raise InputError if that is not possible."""
    for name, text in texts.items():
        write_file(folder / name, text)


def replace_file(path: Path, text: str) -> None:
    """Write a file that somebody may have edited; what was there stays beside it as `.bak`."""
    try:
        if path.is_file() and path.read_bytes() != text.encode():
            path.replace(path.with_name(path.name + ".bak"))
    except OSError as error:
        raise _write_error(error, str(path)) from None
    write_file(path, text)


def log_errors() -> None:
    """Show errors that policies log, and nothing else."""
    logging.basicConfig(level=logging.ERROR, format="%(levelname)s %(message)s")


def print_error(error: RTronError) -> None:
    """Say on standard error what is wrong and what to do about it."""
    from rich.console import Console
    from rich.text import Text

    console = Console(stderr=True, highlight=False)
    rows = [Text.assemble(("error: ", "bold red"), _neutral_lines(str(error)))]
    if error.help:
        rows.append(Text.assemble(("help: ", "bold green"), _neutral_lines(error.help)))
    console.print(*rows, sep="\n", soft_wrap=True)


def _neutral_lines(message: str) -> str:
    return "\n".join(map(sanitize, message.split("\n")))


def print_part(text: str) -> bool:
    """Print a part of what a command says while it goes on; False if nobody reads any more."""
    return _print(text)


def _print(shown: str | Report | Markdown) -> bool:
    try:
        sys.stdout.write(shown if isinstance(shown, str) else _for_terminal(shown))
        sys.stdout.flush()
        return True
    except OSError as error:
        discard_output(sys.stdout)
        if isinstance(error, BrokenPipeError):
            return False
        raise _write_error(error, "standard output") from None


def is_unread(descriptor: int) -> bool:
    """Return whether a file leads to a reader that has gone."""
    poll = select.poll()
    poll.register(descriptor, 0)  # what is always told: POLLERR, POLLHUP
    return bool(poll.poll(0))


def discard_output(file: TextIO) -> None:
    """Let what is written to a file that nobody reads lead nowhere.

    Python flushes standard output and standard error at exit, and would complain then.
    """
    os.dup2(os.open(os.devnull, os.O_WRONLY), file.fileno())


def _for_terminal(shown: Report | Markdown) -> str:
    from rich.console import Console

    return _render(shown, Console())


def _render(shown: str | Report | Markdown, console: Console) -> str:
    if isinstance(shown, str):
        return shown
    from rich.markdown import Markdown

    if isinstance(shown, Markdown) and not console.is_terminal:
        return shown.markup
    with console.capture() as captured:
        console.print(shown, soft_wrap=not isinstance(shown, Markdown))
    return captured.get()


def _write_error(error: OSError, path: str) -> InputError:
    reason = error.strerror or "cannot be written"
    return InputError(reason, path=path, help="choose a file that can be written")

"""A report as lines of text that fit the page where they can and never break a name."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from textwrap import wrap

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

from rtron.sanitize import sanitize

GAP = 2


@dataclass(frozen=True, slots=True)
class TextPage:
    """What a report is printed on: its width in columns, and whether it takes ASCII only."""

    width: int = 80
    ascii_only: bool = False


@dataclass(frozen=True, slots=True)
class Report:
    """A rich renderable that lays its lines out when it learns the page.

    Print it with `soft_wrap=True`: a line longer than the page is then left to the terminal, so
    that a name can be copied whole.
    """

    lay_out: Callable[[TextPage], Iterable[Text]]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        yield from self.lay_out(TextPage(options.max_width, options.ascii_only))


def line(*parts: str | tuple[str, str], indent: int = 0) -> Text:
    """Return a line of parts, each a text or a text and its style; names are made harmless."""
    text = Text(" " * indent)
    for part in parts:
        words, style = (part, "") if isinstance(part, str) else part
        text.append(sanitize(words), style)
    return text


def heading(title: str) -> list[Text]:
    """Return a section's title after an empty line."""
    return [Text(), line((title, "bold"))]


def paragraph(words: str, page: TextPage, *, indent: int = 0, style: str = "") -> list[Text]:
    """Return prose wrapped between words; a word longer than the page stays whole."""
    width = max(page.width - indent, 1)
    rows = wrap(sanitize(words), width, break_long_words=False, break_on_hyphens=False)
    return [line((row, style), indent=indent) for row in rows]


def columns(
    rows: Sequence[Sequence[str]], styles: Sequence[str] = (), *, indent: int = 0
) -> list[Text]:
    """Return rows with their cells in line; a missing style is plain."""
    cells = [[sanitize(cell) for cell in row] for row in rows]
    widths = [max(map(cell_len, column)) for column in zip(*cells, strict=True)]
    return [_row(row, widths, styles, indent) for row in cells]


def _row(row: Sequence[str], widths: Sequence[int], styles: Sequence[str], indent: int) -> Text:
    text = Text(" " * indent)
    for index, (cell, width) in enumerate(zip(row, widths, strict=True)):
        text.append(cell, styles[index] if index < len(styles) else "")
        text.append(" " * (width - cell_len(cell) + GAP))
    text.rstrip()
    return text


def counted(number: int, noun: str) -> str:
    """Return `1 node`, `2 nodes`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"

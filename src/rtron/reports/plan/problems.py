"""What is wrong with a plan, as text for the person who mends it."""

from collections.abc import Iterator, Sequence
from typing import Protocol

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, counted, line, paragraph

_STYLE = {"error": "bold red", "warning": "yellow"}


class Remark(Protocol):
    """A remark on a plan."""

    @property
    def level(self) -> str:
        """`error` or `warning`."""

    @property
    def location(self) -> str:
        """The coordination node or topic that it is about."""

    @property
    def message(self) -> str:
        """What is wrong."""


NOTHING_GUARDED = "This plan guards nothing: none of its coordination nodes stands in a flow."
"""The first line of a report on such a plan."""


def problems_text(title: str, remarks: Sequence[Remark]) -> Report:
    """Return the remarks after their number, or that there is none."""
    return Report(lambda page: _lines(title, remarks, page))


def _lines(title: str, remarks: Sequence[Remark], page: TextPage) -> Iterator[Text]:
    summary = counted(len(remarks), "problem") if remarks else "no problems"
    yield line((title, "bold"), "  ", (summary, "bold" if remarks else "bold green"))
    yield from remark_lines(remarks, page)


def remark_lines(remarks: Sequence[Remark], page: TextPage) -> Iterator[Text]:
    """Yield each remark with its level in colour."""
    for remark in remarks:
        level = (f"{remark.level!s:<9}", _STYLE.get(remark.level, ""))
        yield line(level, (remark.location, "bold"), indent=2)
        yield from paragraph(remark.message, page, indent=11)

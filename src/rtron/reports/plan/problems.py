"""What is wrong with a plan, as text for the person who mends it."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import chain
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


def problems_text(title: str, remarks: Sequence[Remark], *, is_void: bool = False) -> Report:
    """Return the remarks after their number, or that there is none; first that a plan is void."""
    return Report(lambda page: chain(void_lines(is_void=is_void), _lines(title, remarks, page)))


def void_lines(*, is_void: bool) -> Iterator[Text]:
    """Yield the first line of a report on a plan if that guards nothing."""
    if is_void:
        yield line((NOTHING_GUARDED, "bold red"))


def _lines(title: str, remarks: Sequence[Remark], page: TextPage) -> Iterator[Text]:
    summary = counted(len(remarks), "problem") if remarks else "no problems"
    yield line((title, "bold"), "  ", (summary, "bold" if remarks else "bold green"))
    yield from remark_lines(remarks, page)


def remark_lines(remarks: Sequence[Remark], page: TextPage) -> Iterator[Text]:
    """Yield what is remarked, its level in colour, once for all places of which it is said."""
    places: dict[tuple[str, str], list[str]] = defaultdict(list)
    for remark in remarks:
        places[remark.level, remark.message].append(remark.location)
    for (level, message), (first, *others) in places.items():
        yield line((f"{level!s:<9}", _STYLE.get(level, "")), (first, "bold"), indent=2)
        yield from (line((other, "bold"), indent=11) for other in others)
        yield from paragraph(message, page, indent=11)

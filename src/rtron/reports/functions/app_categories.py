"""What kind of apps there are, as a table beside the paper's and as JSON."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from rich.text import Text

from rtron.functions.app_categories import (
    PAPER_APP_COUNT,
    AppProfile,
    CategoryCount,
    NearestCategory,
)
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary import FunctionType

APPS_SCHEMA = "rtron.apps/1"
_NONE = "none of the paper's categories"


def apps_text(rows: Sequence[AppProfile], counts: Sequence[CategoryCount]) -> Report:
    """Return each app with its functions and categories, and how many apps there are of each."""
    return Report(lambda page: _lines(rows, counts, page))


def apps_to_json(rows: Sequence[AppProfile], counts: Sequence[CategoryCount]) -> dict[str, Any]:
    """Return the same as a JSON document, with the nodes of each function."""
    return {
        "schema": APPS_SCHEMA,
        "apps": [
            {
                "app": row.app,
                "functions": {str(name): list(nodes) for name, nodes in row.functions.items()},
                "categories": list(row.categories),
                "nearest": _nearest(row),
            }
            for row in rows
        ],
        "categories": [
            {"names": list(each.categories), "apps": each.apps, "paper": each.paper}
            for each in counts
        ],
    }


def _nearest(row: AppProfile) -> dict[str, Any] | None:
    if row.nearest is None:
        return None
    return {
        "categories": list(row.nearest.categories),
        "missing": list(map(str, row.nearest.missing.missing)),
        "one_of": list(map(str, row.nearest.missing.one_of)),
    }


def _lines(
    rows: Sequence[AppProfile], counts: Sequence[CategoryCount], page: TextPage
) -> Iterator[Text]:
    for row in rows:
        yield from _app(row, page)
    if counts:
        yield from heading(f"{counted(len(rows), 'app')}, beside the paper's {PAPER_APP_COUNT}")
        yield from columns(category_rows(counts, len(rows)), ("", "bold", "dim", "dim"), indent=2)


def _app(row: AppProfile, page: TextPage) -> Iterator[Text]:
    yield line((row.app, "bold"), "  ", (", ".join(row.categories) or _NONE, "green"))
    if row.nearest:
        yield from paragraph(_near(row.nearest, larger=bool(row.categories)), page, indent=2)
    functions = ", ".join(f"{name} {len(nodes)}" for name, nodes in row.functions.items())
    yield from paragraph(functions or "no function is known", page, indent=2, style="dim")


def _near(nearest: NearestCategory, *, larger: bool) -> str:
    lacks = [*map(str, nearest.missing.missing)]
    lacks += [" or ".join(map(str, nearest.missing.one_of))] if nearest.missing.one_of else []
    word = "nearest larger" if larger else "nearest"
    return f"{word}: {' / '.join(nearest.categories)}, without {', '.join(lacks)}"


def category_rows(counts: Iterable[CategoryCount], apps: int) -> list[tuple[str, ...]]:
    """Return the rows of a table: how many of so many apps are of each category, here and there."""
    heads = ("category", "here", "paper", "its functions")
    return [heads, *(_counted(each, apps) for each in counts)]


def _counted(count: CategoryCount, apps: int) -> tuple[str, ...]:
    here, there = _share(count.apps, apps), _share(count.paper, PAPER_APP_COUNT)
    return " / ".join(count.categories), here, there, _set(count)


def _share(number: int, of: int) -> str:
    return f"{number:>3} ({number / of:.1%})" if of else f"{number:>3}"


def _set(each: CategoryCount) -> str:
    """Return a set as the paper writes it, in the order of its table of functions."""
    names = [str(f) for f in FunctionType if f in each.functions]
    names += ["/".join(str(f) for f in FunctionType if f in each.one_of)] if each.one_of else []
    return "+".join(names)

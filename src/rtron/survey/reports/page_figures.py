"""The parts that the sections of a survey's page are made of: figures with links, bars, tables."""

from collections.abc import Iterable, Sequence
from html import escape
from urllib.parse import quote, urlencode

from rtron.sanitize import sanitize

_LEVELS = 8


def text(words: object) -> str:
    """Return words as HTML, whoever chose them."""
    return escape(sanitize(str(words)))


def apps_link(words: object, **filters: object) -> str:
    """Return a link to those apps in the page that fit filters, as `main` of its script knows."""
    address = urlencode(
        {name: sanitize(str(value)) for name, value in filters.items()}, quote_via=quote
    )
    return f'<a href="#{escape(address)}">{text(words)}</a>'


def share_cell(number: int, whole: int, look: str, **filters: object) -> str:
    """Return a cell with a number, its share of a whole and a bar; the number links to its apps."""
    share = number / whole if whole else 0.0
    shown = apps_link(number, **filters) if number and filters else text(number)
    percent = f" <small>{share:.1%}</small>" if whole else ""
    return f'<td class="figure">{shown}{percent}{bar(share, look)}</td>'


def bar(share: float, look: str) -> str:
    """Return a bar as long as a share of 1; `look` is whose it is: paper, ros1 or ros2."""
    return (
        f'<svg class="bar {look}" viewBox="0 0 100 6" preserveAspectRatio="none" '
        'aria-hidden="true">'
        '<rect class="track" width="100" height="6"/>'
        f'<rect width="{100 * min(share, 1.0):.1f}" height="6"/></svg>'
    )


def number_cell(shown: object) -> str:
    """Return a cell of a number that links to nothing."""
    return f'<td class="number">{text(shown)}</td>'


def row(head: str, cells: Iterable[str]) -> str:
    """Return a row; its head is HTML."""
    return f'<tr><th scope="row">{head}</th>{"".join(cells)}</tr>'


def table(heads: Sequence[str], rows: Iterable[str], *, look: str = "") -> str:
    """Return a table in a frame that scrolls where the window is too narrow."""
    columns = "".join(f'<th scope="col">{text(head)}</th>' for head in heads)
    body = "\n".join(rows)
    return (
        f'<div class="frame" tabindex="0"><table class="{look}"><thead><tr>{columns}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def matrix_cell(number: int, largest: int, title: str, **filters: object) -> str:
    """Return a cell of a matrix, the darker the larger its number is."""
    if not number:
        return '<td class="level-0"></td>'
    level = max(1, round(_LEVELS * number / largest))
    link = apps_link(number, **filters)
    return f'<td class="level-{level}" title="{text(title)}">{link}</td>'

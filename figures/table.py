"""The figures, for a person and for a program."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.table import Column, Table

from figures.figure import Figure

_MARKS = {True: "[green]met", False: "[red]missed", None: ""}
_LARGE = 1000


def table(title: str, figures: Sequence[Figure]) -> Table:
    """Return the table that is printed at the end."""
    shown = Table(Column("figure", no_wrap=True), title=title)
    for name in ("ours", "peer", "ratio"):
        shown.add_column(name, justify="right")
    shown.add_column("unit")
    shown.add_column("wanted")
    for figure in figures:
        shown.add_row(figure.name, *_values(figure), figure.unit, _bounds_text(figure))
    return shown


def _values(figure: Figure) -> Iterator[str]:
    """Yield ours, the peer's and the ratio, each with its range over the runs."""
    spread = figure.spread
    ranges = (spread.ours, spread.peer, spread.ratio) if spread else (None, None, None)
    values = (figure.ours, figure.peer, figure.ratio)
    for value, span in zip(values, ranges, strict=True):
        yield f"{number(value)} ({number(span[0])} to {number(span[1])})" if span else number(value)


def number(value: float | None) -> str:
    """Return a number with three digits that mean something, nothing for None."""
    if value is None:
        return ""
    return f"{value:,.0f}" if abs(value) >= _LARGE or value == int(value) else f"{value:.3g}"


def write(figures: Sequence[Figure], path: Path, *, keep: bool) -> None:
    """Write the figures as JSON; `keep` those of other parts that the file has."""
    old = json.loads(path.read_text()) if keep and path.exists() else {}
    path.parent.mkdir(parents=True, exist_ok=True)
    new = old | {figure.name: figure.as_json() for figure in figures}
    path.write_text(json.dumps(new, indent=2) + "\n")


def _bounds_text(figure: Figure) -> str:
    limits = [(">=", figure.at_least), ("<=", figure.at_most), ("ratio <=", figure.ratio_at_most)]
    texts = [f"{sign} {number(bound)}" for sign, bound in limits if bound is not None]
    return " ".join((*texts, _MARKS[figure.met])).strip()

"""Rows as the lines of a CSV file, for a spreadsheet.

A spreadsheet runs a cell that begins like a formula (OWASP, CSV injection), and it may split cells
at other characters than ours: an apostrophe stands before whatever could begin one.
"""

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
from typing import Any

from rtron.sanitize import sanitize

Row = Mapping[str, Any]
TIMES = frozenset({"at", "seen", "stored", "answered", "ended", "created", "stop_at"})
"""Columns with a time, ns since 1970."""

_BYTE_ORDER_MARK = "\ufeff"
_FORMULA = re.compile(r"(^|[;,\t|\"'])(\s*)([=+\-@\uff1d\uff0b\uff0d\uff20])")


def csv_lines(rows: Iterable[Row], columns: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a CSV file (RFC 4180), with a mark that it is UTF-8."""
    yield _BYTE_ORDER_MARK + _line(columns)
    for row in rows:
        yield _line([_cell(name, row.get(name)) for name in columns])


def _line(cells: Sequence[str]) -> str:
    file = io.StringIO()
    csv.writer(file, quoting=csv.QUOTE_ALL).writerow(cells)
    return file.getvalue()


def _cell(name: str, value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, (bool, int, float)):
        return _time(value) if name in TIMES else str(value).lower()
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return _FORMULA.sub(r"\1\2'\3", sanitize(text))


def _time(at: float) -> str:
    moment = datetime.fromtimestamp(at / 1e9, tz=timezone.utc)
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")

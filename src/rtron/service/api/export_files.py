"""Rows as files for other programs: CSV for a spreadsheet, JSON with everything as it is."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from fastapi.responses import StreamingResponse

from rtron.reports.csv_lines import Row, csv_lines
from rtron.vocabulary import StringEnum


def json_array(rows: Iterable[Row], _columns: Sequence[str]) -> Iterator[str]:
    """Yield the lines of a JSON array of objects, times in ns since 1970."""
    separator = "[\n"
    for row in rows:
        yield separator + json.dumps(row)
        separator = ",\n"
    yield "[]\n" if separator == "[\n" else "\n]\n"


class ExportFormat(StringEnum):
    """What a file is for: a spreadsheet, or a program."""

    CSV = "csv"
    JSON = "json"


_MEDIA_TYPES: Mapping[ExportFormat, str] = {
    ExportFormat.CSV: "text/csv; charset=utf-8",
    ExportFormat.JSON: "application/json",
}
_LINES: Mapping[ExportFormat, Callable[[Iterable[Row], Sequence[str]], Iterator[str]]] = {
    ExportFormat.CSV: csv_lines,
    ExportFormat.JSON: json_array,
}


def export_file(
    name: str, rows: Iterable[Row], columns: Sequence[str], format: ExportFormat
) -> StreamingResponse:
    """Return rows as a file that a browser stores."""
    headers = {"Content-Disposition": f'attachment; filename="rtron-{name}.{format.value}"'}
    lines = _LINES[format](rows, columns)
    return StreamingResponse(lines, media_type=_MEDIA_TYPES[format], headers=headers)

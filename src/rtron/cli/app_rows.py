"""What kind of app each is whose interaction graph `rtron functions apps` is given."""

from collections.abc import Sequence
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.functions.app_categories import AppRow, app_row
from rtron.functions.reading import Note, Skipped
from rtron.sources.graph_json import read_graph
from rtron.sources.workspace.package_files import is_regular


def app_rows(given: Sequence[Path], left: Note) -> list[AppRow]:
    """Return the apps of files, or of those in folders; several are named by their files.

    What cannot be read goes to `left`. Raise InputError if nothing can.
    """
    files = [file for path in given for file in _files(path, left)]
    tried = [(file, _row(file, file.stem if len(files) > 1 else "")) for file in files]
    rows = [row for _, row in tried if isinstance(row, AppRow)]
    for file, fault in tried:
        if isinstance(fault, InputError):
            if not rows:
                raise fault
            place = f"{file}:{fault.line}" if fault.line else str(file)
            left(Skipped(place=place, why=fault.why))
    return rows


def _row(file: Path, name: str) -> AppRow | InputError:
    try:
        return app_row(read_graph(file), name)
    except InputError as error:
        return error


def _files(path: Path, left: Note) -> list[Path]:
    """Return a file, or those in a folder by name: a pipe in it would be waited for."""
    if not is_folder(path):
        return [path]
    inside = sorted(path.glob("*.json"))
    for other in (each for each in inside if not is_regular(each)):
        left(Skipped(place=str(other), why="is no file"))
    found = [each for each in inside if is_regular(each)]
    if not found:
        help = "write them with `rtron scan … --format graph -o app.json`"
        raise InputError("has no *.json", path=str(path), help=help)
    return found

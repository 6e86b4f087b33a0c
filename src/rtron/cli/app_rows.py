"""What kind of app each is whose interaction graph `rtron functions apps` is given."""

from collections.abc import Sequence
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.functions.app_categories import AppProfile, app_profile
from rtron.functions.reading import SkippedEntry, SkippedHandler
from rtron.sources.graph_json import read_graph
from rtron.sources.workspace.package_files import is_regular


def read_app_rows(paths: Sequence[Path], note_skipped: SkippedHandler) -> list[AppProfile]:
    """Return the apps of files, or of those in folders; several are named by their files.

    What cannot be read goes to `note_skipped`. Raise InputError if nothing can.
    """
    files = [file for path in paths for file in _graph_files(path, note_skipped)]
    results = [(file, _read_row(file, file.stem if len(files) > 1 else "")) for file in files]
    rows = [row for _, row in results if isinstance(row, AppProfile)]
    for file, error in results:
        if isinstance(error, InputError):
            if not rows:
                raise error
            location = f"{file}:{error.line}" if error.line else str(file)
            note_skipped(SkippedEntry(location=location, reason=error.reason))
    return rows


def _read_row(file: Path, name: str) -> AppProfile | InputError:
    try:
        return app_profile(read_graph(file), name)
    except InputError as error:
        return error


def _graph_files(path: Path, note_skipped: SkippedHandler) -> list[Path]:
    """Return a file, or those in a folder by name: a pipe in it would be waited for."""
    if not is_folder(path):
        return [path]
    candidates = sorted(path.glob("*.json"))
    for other in (each for each in candidates if not is_regular(each)):
        note_skipped(SkippedEntry(location=str(other), reason="is no file"))
    found = [each for each in candidates if is_regular(each)]
    if not found:
        help = "write them with `rtron scan … --format graph -o app.json`"
        raise InputError("has no *.json", path=str(path), help=help)
    return found

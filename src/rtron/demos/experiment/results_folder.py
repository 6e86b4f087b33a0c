"""The folder that the results go to: made, looked at before anything starts, and cleared."""

import json
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryFile

from rtron.demos.cases import CASES
from rtron.errors import InputError

SCHEMA = "rtron.demo/1"
RESULTS = "results.json"
REPORT = "report.html"
PLAN = "rtron.yaml"
LOG = "log"
_COPIED = ("graph.json", "proposed.yaml", "bridge.yaml", LOG)
_OF_A_CASE = ("trajectories.png", "velocity.png", "verdicts.png", "incident.png", "incident.mcap")
_RESULTS_HEAD = re.compile(r'\s*\{\s*"schema":\s*"rtron\.demo/')
_HEAD = 200
_HELP = "choose a folder with -o"


def prepare_results_folder(out: Path) -> Path:
    """Return the folder for the results, made if it is not there.

    InputError if it cannot be made or written to, or if it has files that are no earlier results.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        is_empty = not any(out.iterdir())
        with TemporaryFile(dir=out):
            pass
    except FileExistsError:
        raise InputError("is no folder", path=str(out), help=_HELP) from None
    except OSError as error:
        raise InputError(error.strerror or "cannot be made", path=str(out), help=_HELP) from None
    if not is_empty and not _has_results(out):
        help = f"{_HELP} that is empty, new, or has the results of an earlier demo"
        raise InputError("holds other files", path=str(out), help=help)
    return out


def remove_earlier_results(out: Path) -> None:
    """Remove what an earlier demonstration has written, by its names; a link is not followed."""
    for path in (out / name for name in _artifact_names()):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def copy_artifacts(work: Path, out: Path, names: Sequence[str] = _COPIED) -> None:
    """Copy what is of use later from the folder of work."""
    for path in (work / name for name in names if (work / name).exists()):
        if path.is_dir():
            shutil.copytree(path, out / path.name)
        else:
            shutil.copy(path, out / path.name)


def copy_logs(work: Path, out: Path, error: str) -> Path | None:
    """Leave the logs of a demonstration that failed with `error`, in place of earlier results.

    Returns the folder that they are in; None if it failed before there were any.
    """
    if not (work / LOG).is_dir():
        return None
    remove_earlier_results(out)
    copy_artifacts(work, out, [LOG])
    (out / RESULTS).write_text(json.dumps({"schema": SCHEMA, "error": error}) + "\n")
    return out / LOG


def _has_results(out: Path) -> bool:
    results = out / RESULTS
    if not results.is_file():
        return False
    try:
        with results.open(encoding="utf-8") as file:
            return _RESULTS_HEAD.match(file.read(_HEAD)) is not None
    except (OSError, ValueError):
        return False


def _artifact_names() -> Iterator[str]:
    yield from (REPORT, RESULTS, PLAN, *_COPIED)
    for case in CASES:
        yield from (f"{case}-{name}" for name in _OF_A_CASE)

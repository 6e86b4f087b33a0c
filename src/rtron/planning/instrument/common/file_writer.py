"""Writes a guarded launch: every file is complete before any is in its place."""

import os
import shutil
import tempfile
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.guarded_launch import GUARD_SCRIPT, PLAN_FILE, GuardedLaunch

_SCRIPT_MODE = 0o755
_TEXT_MODE = 0o644


def write_guarded_launch(guarded: GuardedLaunch) -> None:
    """Write the files; the launch file comes last, and an earlier guarded launch is replaced.

    Raise InputError if the folder is there and no earlier guarded launch's, or for no access.
    """
    launch, folder = guarded.launch, guarded.folder
    if folder.exists() and not all((folder / name).is_file() for name in (GUARD_SCRIPT, PLAN_FILE)):
        help = "choose another name for the guarded launch"
        raise InputError("is there already and not RTron's", path=str(folder), help=help)
    try:
        launch.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".rtron-", dir=launch.parent) as stage:
            _stage(guarded, Path(stage))
            _publish(Path(stage), launch, folder)
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", path=str(launch)) from None


def _stage(guarded: GuardedLaunch, stage: Path) -> None:
    top = guarded.launch.parent
    for path, text in guarded.files.items():
        staged = _with_folder(stage / path.relative_to(top))
        staged.write_bytes(text.encode(errors="surrogateescape"))
        staged.chmod(_SCRIPT_MODE if text.startswith("#!") else _TEXT_MODE)
    for path, original in guarded.copies.items():
        staged = _with_folder(stage / path.relative_to(top))
        shutil.copyfile(original, staged)
        staged.chmod(_SCRIPT_MODE)
    for path, original in guarded.links.items():
        _with_folder(stage / path.relative_to(top)).symlink_to(original)


def _with_folder(path: Path) -> Path:
    """Return a path whose folder is there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _publish(stage: Path, launch: Path, folder: Path) -> None:
    """Move what is staged to its place; what it replaces goes away with the stage."""
    if folder.exists():
        folder.rename(stage / "replaced")
    (stage / folder.name).rename(folder)
    os.replace(stage / launch.name, launch)  # noqa: PTH105 - says what it does

"""Keeping the figures of a run in a file, whole at every moment."""

import os
from dataclasses import dataclass
from pathlib import Path

from rtron.cli.support.outcome import as_json
from rtron.errors import InputError
from rtron.sources.run_json import run_to_json
from rtron.vocabulary import MeasuredRun


@dataclass(frozen=True, slots=True)
class RunFileWriter:
    """Writes runs to a file, each in place of the one before; goes to the guard's own process."""

    path: Path

    def __call__(self, run: MeasuredRun) -> None:
        """Write a run; InputError if that is not possible."""
        temporary = self.path.with_name(f".{self.path.name}.{os.getpid()}")
        try:
            temporary.unlink(missing_ok=True)
            with temporary.open("x", encoding="utf-8") as file:
                file.write(as_json(run_to_json(run)))
            temporary.replace(self.path)
        except OSError as error:
            reason = error.strerror or "cannot be written"
            raise InputError(reason, path=str(self.path), help="choose another file") from None
        finally:
            _remove(temporary)


def _remove(path: Path) -> None:
    """Remove what a failed write has left."""
    try:
        path.unlink(missing_ok=True)
    except OSError:
        return

"""A JSON object in a file of the user's state folder (XDG base folders): it outlives a reboot.

A thread writes the file, since a disk may hang.
"""

import json
import logging
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rtron.errors import RTronError
from rtron.guard.core.event_loop import BackgroundWorker
from rtron.guard.system.durable_file import make_private_folder, remove_file, replace_file
from rtron.guard.system.unix_socket import open_own_folder

log = logging.getLogger(__name__)

_MOST_BYTES = 1 << 18
_RETRY_S = 1.0
_END_S, _PAUSE_S = 1.0, 0.01
"""How long the end of a process waits for the disk."""
_HELP = "set XDG_STATE_HOME to a folder of your own (mode 700)"


class StateFile:
    """Keeps the object that was saved last; what could not be written is tried again each second.

    An empty object is no file.
    """

    def __init__(self, path: Path, loss: str) -> None:
        """`loss` says in the log what a file means that cannot be written."""
        self.path = path
        self.failure = ""
        """Why the last try to write failed, "" if it did not."""
        self._loss = loss
        self._state: Mapping[str, Any] = {}
        self._saved: Mapping[str, Any] = self._state
        self._worker: BackgroundWorker | None = None

    @property
    def is_saved(self) -> bool:
        """Whether the disk has the state of the last `save`, so that a power cut leaves it."""
        return self._saved is self._state

    def read(self) -> dict[str, Any]:
        """Return what the file has; OSError or ValueError if it cannot be read.

        SourceError if others may enter its folder.
        """
        if not self.path.parent.is_dir():
            return {}
        os.close(open_own_folder(self.path.parent, _HELP))
        if not self.path.exists():
            return {}
        with self.path.open("rb") as file:
            return _json_object(file.read(_MOST_BYTES))

    def save(self, state: Mapping[str, Any]) -> None:
        """Have the state written."""
        self._state = state
        if self._worker is None:
            self._worker = BackgroundWorker(self._save, "state-file")
        self._worker.request()

    def open(self) -> None:
        """Do nothing: what is saved is written at once."""

    def close(self) -> None:
        """Wait until all is written, a second at most; say so if it is not."""
        until = time.monotonic() + _END_S
        while not self.is_saved and time.monotonic() < until:
            time.sleep(_PAUSE_S)
        if not self.is_saved:
            log.error("%s: %s", self._loss, self.failure or "the disk is slow")

    def _save(self) -> None:
        """Write the state, in the thread; try again later if that fails."""
        state, failure = self._state, ""
        try:
            self._write(state)
            self._saved = state
        except (OSError, RTronError) as error:
            failure = str(error)
        if failure and failure != self.failure:
            log.error("%s: %s", self._loss, failure)
        self.failure = failure
        if failure and self._worker:
            time.sleep(_RETRY_S)
            self._worker.request()

    def _write(self, state: Mapping[str, Any]) -> None:
        make_private_folder(self.path.parent)
        os.close(open_own_folder(self.path.parent, _HELP))
        if state:
            replace_file(self.path, json.dumps(state).encode())
        else:
            remove_file(self.path)


def _json_object(data: bytes) -> dict[str, Any]:
    try:
        value = json.loads(data)
    except RecursionError:
        raise ValueError("its JSON is nested too deep") from None
    if not isinstance(value, dict):
        raise ValueError("no JSON object")  # noqa: TRY004 - of the file, as any other content
    return value

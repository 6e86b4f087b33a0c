"""The intrusions that nobody has cleared, in a file: they outlive the guard and its supervisor.

It lies in the user's state folder (XDG base folders): a logout and a reboot leave it there, too.
"""

import json
import logging
import os
import time
from pathlib import Path

from rtron.errors import RTronError, SourceError
from rtron.guard.core.event_loop import BackgroundWorker
from rtron.guard.intrusion_latch import handover_document, intrusions_in
from rtron.guard.supervision.double_buffer import DoubleBuffer
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.system.durable_file import make_private_folder, remove_file, replace_file
from rtron.guard.system.master_name import master_file_name
from rtron.guard.system.state_folder import state_folder
from rtron.guard.system.unix_socket import open_own_folder
from rtron.vocabulary import SECOND, OnForeign, build_streams

log = logging.getLogger(__name__)

_MOST_BYTES = 1 << 18
_HELP = "set XDG_STATE_HOME to a folder of your own (mode 700)"
_RETRY = SECOND
_PAUSE_S = 0.01


class IntrusionFile:
    """What intruders have stopped under one plan at one master, and why.

    A thread writes the file, since a disk may hang; what could not be written is tried again.
    """

    def __init__(self, path: Path, topics: frozenset[str]) -> None:
        """`topics` are the plan's: what stands in the file of others, of an older plan, is void."""
        self._path = path
        self._topics = topics
        self._reasons: dict[str, str] | None = None
        self._saved: dict[str, str] | None = None
        self._seen: tuple[DoubleBuffer, tuple[int, int, int]] | None = None
        self._retry_at = 0
        self._failure = ""
        self._worker = BackgroundWorker(self._save, "intrusions")

    @property
    def is_saved(self) -> bool:
        """Whether the file has what a guard has told last."""
        return self._reasons is None or self._reasons == self._saved

    def handover_document(self) -> bytes:
        """Return what the first guard inherits.

        SourceError if the file cannot be read, or if others may enter its folder.
        """
        try:
            reasons = self._read()
        except (OSError, ValueError, TypeError, RecursionError) as error:
            raise SourceError(
                f"{self._path}: what intruders have stopped cannot be read: {error}",
                help="make sure that no intruder is there, and remove the file",
            ) from None
        self._saved = {topic: reasons[topic] for topic in reasons if topic in self._topics}
        for topic, reason in self._saved.items():
            log.warning("%s is still stopped, nobody has cleared it: %s", topic, reason)
        return handover_document(self._saved)

    def follow(self, handover_state: DoubleBuffer, now: int) -> None:
        """Have the intrusions saved that a guard's handover state tells of; `now` in ns."""
        head = handover_state.head()
        if self._seen != (handover_state, head):
            self._look(handover_state, head)
        if not self.is_saved and now >= self._retry_at:
            self._retry_at = now + _RETRY
            self._worker.request()

    def finish(self, timeout: float) -> None:
        """Wait for what is being saved, s; say so if it is not on the disk then."""
        until = time.monotonic() + timeout
        while not self.is_saved and time.monotonic() < until:
            time.sleep(_PAUSE_S)
        if not self.is_saved:
            log.error("%s: what intruders have stopped is not saved", self._path)

    def _look(self, handover_state: DoubleBuffer, head: tuple[int, int, int]) -> None:
        count, document = handover_state.read()
        if count and count == head[0]:  # else the guard has told nothing, or is writing it
            self._seen = handover_state, head
            self._reasons = intrusions_in(document)
            self._retry_at = 0

    def _save(self) -> None:
        reasons, failure = self._reasons, ""
        if reasons is None:
            return
        try:
            self._write(reasons)
            self._saved = reasons
        except (OSError, RTronError) as error:
            failure = str(error)
        if failure and failure != self._failure:
            log.error("what intruders have stopped is not kept for a new guard: %s", failure)
        self._failure = failure

    def _write(self, reasons: dict[str, str]) -> None:
        self._check_folder()
        if reasons:
            replace_file(self._path, json.dumps(reasons).encode())
        else:
            remove_file(self._path)

    def _read(self) -> dict[str, str]:
        if not self._path.parent.is_dir():
            return {}
        self._check_folder()
        try:
            with self._path.open("rb") as file:
                reasons = json.loads(file.read(_MOST_BYTES))
        except FileNotFoundError:
            return {}
        if not isinstance(reasons, dict):
            raise TypeError("no JSON object")
        return {topic: str(reason) for topic, reason in reasons.items()}

    def _check_folder(self) -> None:
        make_private_folder(self._path.parent)
        os.close(open_own_folder(self._path.parent, _HELP))


def intrusion_file(config: GuardConfig) -> IntrusionFile | None:
    """Return the file of a guard; None if intruders stop nothing there."""
    plan = config.plan
    if config.options.get("dry_run") or plan.audit.on_foreign is not OnForeign.STOP:
        return None
    path = state_folder(plan.app) / f"intrusions-{master_file_name(config.master)}.json"
    return IntrusionFile(path, frozenset(each.topic for each in build_streams(plan)))

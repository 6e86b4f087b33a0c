"""The intrusions that nobody has cleared, in a file: they outlive the guard and its supervisor.

A logout and a reboot leave it there, too.
"""

import logging
import time

from rtron.errors import SourceError
from rtron.guard.core.state_file import StateFile
from rtron.guard.intrusion_latch import handover_document, intrusions_in
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.shared_memory import DoubleBuffer
from rtron.guard.system.state_folder import master_file_name, state_folder
from rtron.vocabulary import OnForeign, build_streams

log = logging.getLogger(__name__)

_PAUSE_S = 0.01


class IntrusionFile:
    """What intruders have stopped under one plan at one master, and why."""

    def __init__(self, file: StateFile, topics: frozenset[str]) -> None:
        """`topics` are the plan's: what stands in the file of others, of an older plan, is void."""
        self._file = file
        self._topics = topics
        self._reasons: dict[str, str] | None = None
        self._seen: tuple[DoubleBuffer, tuple[int, int, int]] | None = None

    @property
    def is_saved(self) -> bool:
        """Whether the file has what a guard has told last."""
        return self._file.is_saved

    def handover_document(self) -> bytes:
        """Return what the first guard inherits.

        SourceError if the file cannot be read, or if others may enter its folder.
        """
        try:
            reasons = self._file.read()
        except (OSError, ValueError) as error:
            raise SourceError(
                f"{self._file.path}: what intruders have stopped cannot be read: {error}",
                help="make sure that no intruder is there, and remove the file",
            ) from None
        self._reasons = {topic: str(why) for topic, why in reasons.items() if topic in self._topics}
        for topic, reason in self._reasons.items():
            log.warning("%s is still stopped, nobody has cleared it: %s", topic, reason)
        return handover_document(self._reasons)

    def follow(self, handover_state: DoubleBuffer) -> None:
        """Have the intrusions saved that a guard's handover state tells of."""
        head = handover_state.head()
        if self._seen != (handover_state, head):
            self._look(handover_state, head)

    def finish(self, timeout: float) -> None:
        """Wait for what is being saved, s; say so if it is not on the disk then."""
        until = time.monotonic() + timeout
        while not self.is_saved and time.monotonic() < until:
            time.sleep(_PAUSE_S)
        if not self.is_saved:
            log.error("%s: what intruders have stopped is not saved", self._file.path)

    def _look(self, handover_state: DoubleBuffer, head: tuple[int, int, int]) -> None:
        count, document = handover_state.read()
        if count and count == head[0]:  # else the guard has told nothing, or is writing it
            self._seen = handover_state, head
            reasons = intrusions_in(document)
            if reasons != self._reasons:
                self._reasons = reasons
                self._file.save(reasons)


def intrusion_file(config: GuardConfig) -> IntrusionFile | None:
    """Return the file of a guard; None if intruders stop nothing there."""
    plan = config.plan
    if config.options.get("dry_run") or plan.audit.on_foreign is not OnForeign.STOP:
        return None
    path = state_folder(plan.app) / f"intrusions-{master_file_name(config.master)}.json"
    file = StateFile(path, "what intruders have stopped is not kept for a new guard")
    return IntrusionFile(file, frozenset(each.topic for each in build_streams(plan)))

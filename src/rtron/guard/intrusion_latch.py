"""The intrusions that nobody has cleared yet: what they stopped stays stopped until a person does.

The next guard inherits them, and the supervisor reads them, from the handover state. A file of the
user's state folder has them for the time after the supervisor.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.core.handover_state import INTRUSIONS
from rtron.guard.core.state_file import StateFile
from rtron.guard.system.state_folder import master_file_name, state_folder

if TYPE_CHECKING:
    from rtron.guard.core.handover_state import HandoverState
    from rtron.vocabulary import Plan

log = logging.getLogger(__name__)

OnRefusal = Callable[[str], None]
"""Takes why something is refused, "" if it is not."""
_MAX_REASON_LENGTH = 300


class IntrusionLatch:
    """The public names of the streams that intruders have stopped, each with the reason."""

    def __init__(self, handover: HandoverState) -> None:
        """Take over what the guard before has left."""
        self._handover = handover
        self._reasons = _checked(handover.inherited(INTRUSIONS))
        self._file: StateFile | None = None
        self.clear: Callable[[str, OnRefusal], None] = _refuse
        """Clears a stream, and tells why that is refused, "" if it is not. Set by the audit."""
        self.on_clear: Callable[[str, str], None] = lambda topic, reason: None
        """Called with each stream that a person has cleared, and by whom and why."""

    def keep(self, file: StateFile, topics: Collection[str]) -> None:
        """Keep the intrusions in a file, too; without a guard before, those in it stand again.

        `topics` are the plan's: what stands in the file of others, of an older plan, is void.
        SourceError if the file cannot be read.
        """
        if self._handover.inherited(INTRUSIONS) is None:
            stored = _read(file)
            self._reasons = {topic: why for topic, why in stored.items() if topic in topics}
        for topic, reason in self._reasons.items():
            log.warning("%s is still stopped, nobody has cleared it: %s", topic, reason)
        self._file = file
        self._store()

    @property
    def reasons(self) -> dict[str, str]:
        """The reasons by stream."""
        return dict(self._reasons)

    def add(self, topic: str, reason: str) -> None:
        """Remember that an intruder has stopped a stream, until `remove`."""
        if topic not in self._reasons:
            self._reasons[topic] = reason[:_MAX_REASON_LENGTH]
            self._store()

    def remove(self, topic: str) -> None:
        """Forget it."""
        if self._reasons.pop(topic, None) is not None:
            self._store()

    def _store(self) -> None:
        self._handover.store(INTRUSIONS, self._reasons)
        if self._file:
            self._file.save(self.reasons)


def intrusion_file(plan: Plan, master: str) -> StateFile:
    """Return the file of a guard at a master or in a domain."""
    path = state_folder(plan.app) / f"intrusions-{master_file_name(master)}.json"
    return StateFile(path, "what intruders have stopped is not kept for a new guard")


def _read(file: StateFile) -> dict[str, str]:
    try:
        return {topic: str(why) for topic, why in file.read().items()}
    except (OSError, ValueError) as error:
        raise SourceError(
            f"{file.path}: what intruders have stopped cannot be read: {error}",
            help="make sure that no intruder is there, and remove the file",
        ) from None


def intrusions_in(handover_document: bytes) -> dict[str, str]:
    """Return the streams that intruders have stopped, and why, as a guard's handover state tells.

    None of them if it is no handover state.
    """
    try:
        document = json.loads(handover_document or b"{}")
    except (ValueError, RecursionError):
        return {}
    return _checked(document.get(INTRUSIONS) if isinstance(document, dict) else None)


def _refuse(topic: str, on_refusal: OnRefusal) -> None:
    on_refusal(f"{topic} is not audited")


def _checked(reasons: object) -> dict[str, str]:
    items = reasons.items() if isinstance(reasons, dict) else ()
    return {k: v for k, v in items if isinstance(k, str) and isinstance(v, str)}

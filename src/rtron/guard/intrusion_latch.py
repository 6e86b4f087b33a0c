"""The intrusions that nobody has cleared yet: what they stopped stays stopped until a person does.

The next guard inherits them, and the supervisor reads them, from the handover state. The supervisor
keeps them in a file, too (`supervision/intrusion_file.py`): they outlive both.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from rtron.guard.core.handover_state import INTRUSIONS

if TYPE_CHECKING:
    from rtron.guard.core.handover_state import HandoverState

OnRefusal = Callable[[str], None]
"""Takes why something is refused, "" if it is not."""
_MAX_REASON_LENGTH = 300


class IntrusionLatch:
    """The public names of the streams that intruders have stopped, each with the reason."""

    def __init__(self, handover: HandoverState) -> None:
        """Take over what the guard before has left."""
        self._handover = handover
        self._reasons = _checked(handover.inherited(INTRUSIONS))
        self.clear: Callable[[str, OnRefusal], None] = _refuse
        """Clears a stream, and tells why that is refused, "" if it is not. Set by the audit."""
        self.on_clear: Callable[[str, str], None] = lambda topic, reason: None
        """Called with each stream that a person has cleared, and by whom and why."""

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
        self._handover.store(INTRUSIONS, self._reasons or None)


def intrusions_in(handover_document: bytes) -> dict[str, str]:
    """Return the streams that intruders have stopped, and why, as a guard's handover state tells.

    None of them if it is no handover state.
    """
    try:
        document = json.loads(handover_document or b"{}")
    except (ValueError, RecursionError):
        return {}
    return _checked(document.get(INTRUSIONS) if isinstance(document, dict) else None)


def handover_document(reasons: Mapping[str, str]) -> bytes:
    """Return the handover state of a guard that has stopped these streams, with the reasons."""
    return json.dumps({INTRUSIONS: dict(reasons)}).encode()


def _refuse(topic: str, on_refusal: OnRefusal) -> None:
    on_refusal(f"{topic} is not audited")


def _checked(reasons: object) -> dict[str, str]:
    items = reasons.items() if isinstance(reasons, dict) else ()
    return {k: v for k, v in items if isinstance(k, str) and isinstance(v, str)}

"""From a guard's event to a row, and from a row to what the API says.

What comes from a guard is a stranger's: texts are cut to their columns, values that are no JSON or
too long are left out. PostgreSQL takes no NUL in a text.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

from rtron.errors import WireError
from rtron.service.domain.schemas import EventView
from rtron.vocabulary import GuardEvent

LONGEST_VALUES = 1 << 16
"""The longest `values` of an event, characters of JSON."""
LONGEST_RUN = 40
_LARGEST = (1 << 63) - 1
_VIEWED = EventView.model_fields.keys() - {"robot"}


def check(event: GuardEvent) -> None:
    """Raise WireError for an event that cannot be told from others, or of no possible time."""
    if not 0 < len(event.run) <= LONGEST_RUN or "\0" in event.run:
        raise WireError(f"a run has 1 to {LONGEST_RUN} characters")
    if not 0 < event.number <= _LARGEST:
        raise WireError(f"event {event.number}: they count from 1")
    if not (0 <= event.at <= _LARGEST and 0 <= event.revision <= _LARGEST):
        raise WireError(f"event {event.number}: its time or revision is out of range")


def row(robot_id: int, now: int, event: GuardEvent) -> dict[str, Any]:
    """Return the row of a checked event that is stored at `now` (ns), without its id."""
    return {
        "robot_id": robot_id,
        "run": event.run,
        "number": event.number,
        "at": event.at,
        "stored": now,
        "kind": event.kind.value,
        "level": event.level.value,
        "node": _text(event.node, 200),
        "topic": _text(event.topic, 300),
        "flow": _text(event.flow, 200),
        "publisher": _text(event.publisher, 300),
        "policy": event.policy.value if event.policy else "",
        "decision": event.decision.value if event.decision else "",
        "reason": _text(event.reason, 1000),
        "revision": event.revision,
        "values": _values(event.values) if event.values else {},
    }


def view(robot: str, row: Mapping[str, Any]) -> EventView:
    """Return a stored event, with its id, as the API says it."""
    return EventView(robot=robot, **{name: row[name] for name in _VIEWED})


def _text(text: str, longest: int) -> str:
    return text[:longest].replace("\0", "\ufffd")


def _values(values: Mapping[str, Any]) -> Mapping[str, Any]:
    try:
        written = json.dumps(values, allow_nan=False)
    except ValueError:
        return _values(_finite(values))
    return values if len(written) <= LONGEST_VALUES else {"left_out": len(written)}


def _finite(value: Any) -> Any:  # noqa: ANN401 - any JSON value
    """Return the value with null for what JSON cannot say: NaN and the infinities."""
    if isinstance(value, Mapping):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value

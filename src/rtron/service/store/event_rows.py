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

MAX_VALUES_LENGTH = 1 << 16
"""The longest `values` of an event, characters of JSON."""
MAX_RUN_LENGTH = 40
_MAX_INT64 = (1 << 63) - 1
_VIEW_COLUMNS = EventView.model_fields.keys() - {"robot"}
EVENT_CONTENT = (*sorted(_VIEW_COLUMNS - {"id"}), "run", "number", "stored")
"""The columns of an event that are in its chain, beside the name of its robot."""


def check_event(event: GuardEvent) -> None:
    """Raise WireError if an event's run, number, time or revision is out of range."""
    check_run(event.run)
    if not 0 < event.number <= _MAX_INT64:
        raise WireError(f"event {event.number}: they count from 1")
    if not (0 <= event.at <= _MAX_INT64 and 0 <= event.revision <= _MAX_INT64):
        raise WireError(f"event {event.number}: its time or revision is out of range")


def check_run(run: str) -> None:
    """Raise WireError for what is no life of a guard."""
    if not 0 < len(run) <= MAX_RUN_LENGTH or "\0" in run:
        raise WireError(f"a run has 1 to {MAX_RUN_LENGTH} characters")


def event_row(robot_id: int, now: int, event: GuardEvent) -> dict[str, Any]:
    """Return the row of a checked event that is stored at `now` (ns), without its id."""
    return {
        "robot_id": robot_id,
        "run": event.run,
        "number": event.number,
        "at": event.at,
        "stored": now,
        "kind": event.kind.value,
        "level": event.level.value,
        "node": _clean_text(event.node, 200),
        "topic": _clean_text(event.topic, 300),
        "flow": _clean_text(event.flow, 200),
        "publisher": _clean_text(event.publisher, 300),
        "policy": event.policy.value if event.policy else "",
        "decision": event.decision.value if event.decision else "",
        "reason": _clean_text(event.reason, 1000),
        "revision": event.revision,
        "values": _json_values(event.values) if event.values else {},
    }


def event_content(robot: str, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a chain has of a stored event: everything but its id."""
    return {"robot": robot, **{name: row[name] for name in EVENT_CONTENT}}


def event_view(robot: str, row: Mapping[str, Any]) -> EventView:
    """Return a stored event, with its id, as the API says it."""
    return EventView(robot=robot, **{name: row[name] for name in _VIEW_COLUMNS})


def _clean_text(text: str, max_length: int) -> str:
    return text[:max_length].replace("\0", "\ufffd")


def _json_values(values: Mapping[str, Any]) -> Mapping[str, Any]:
    try:
        written = json.dumps(values, allow_nan=False)
    except ValueError:
        return _json_values(_finite(values))
    return values if len(written) <= MAX_VALUES_LENGTH else {"left_out": len(written)}


def _finite(value: Any) -> Any:  # noqa: ANN401 - any JSON value
    """Return the value with null for what JSON cannot say: NaN and the infinities."""
    if isinstance(value, Mapping):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value

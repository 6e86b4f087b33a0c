"""An alarm of a robot as people refer to it, and who has seen it."""

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel

from rtron.vocabulary import Alarm

MAX_TEXT = 300

HANDOVER_MESSAGE = {"type": "handover"}
"""The live message that somebody has written a handover note."""

AlarmKey = tuple[str, str, str, str]
"""What tells one alarm of a robot from another: kind, topic, node, peer."""


class Acknowledgement(BaseModel):
    """Who has seen an alarm, when (ns), and the note; `ended` when the guard told of it again."""

    robot: str
    kind: str
    topic: str
    node: str
    peer: str
    by: str
    note: str
    at: int
    ended: int | None

    @property
    def key(self) -> AlarmKey:
        """What tells its alarm from the robot's other alarms."""
        return self.kind, self.topic, self.node, self.peer


def alarm_key(alarm: Alarm) -> AlarmKey:
    """Return what tells an alarm from another, cut as it is stored."""
    return clean_key(alarm.kind.value, alarm.topic, alarm.node, alarm.peer)


def clean_key(kind: str, topic: str, node: str, peer: str) -> AlarmKey:
    """Return the parts of a key, which are a stranger's, as every database takes them."""
    return _clean(kind), _clean(topic), _clean(node), _clean(peer)


def without_nul(text: str) -> str:
    """Return a text as every database takes it."""
    return text.replace("\0", "\ufffd")


def acknowledged_change(left: Sequence[Acknowledgement]) -> dict[str, Any]:
    """Return what differs of a robot of whose alarms these are acknowledged now."""
    return {"acknowledged": [each.model_dump(mode="json") for each in left]}


def _clean(text: str) -> str:
    return without_nul(text[:MAX_TEXT])

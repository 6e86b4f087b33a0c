"""An Alarm: something that should not be so while the app runs, until it is so no more."""

from dataclasses import dataclass

from rtron.vocabulary.enums import StringEnum


class AlarmKind(StringEnum):
    """What an alarm is about."""

    FOREIGN_PUBLISHER = "foreign publisher"
    UNREGISTERED_PUBLISHER = "ghost publisher"
    IMPOSTOR = "impostor"
    DRIFT = "drift"
    UNREACHABLE = "unseen"
    UNREADABLE = "unreadable"
    GUARD = "guard"
    SUPERVISOR = "supervisor"


@dataclass(frozen=True, slots=True, kw_only=True)
class Alarm:
    """What is wrong, where, and who does it as far as that is known.

    `node` is whom it concerns, `peer` the other end: a node's name or an address.
    """

    kind: AlarmKind
    reason: str
    topic: str = ""
    node: str = ""
    peer: str = ""

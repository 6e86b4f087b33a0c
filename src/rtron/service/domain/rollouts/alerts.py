"""What people are told at once of a roll-out: consoles of what is new, webhooks of the worst."""

from collections.abc import Collection, Hashable, Mapping, Sequence
from typing import Any

from rtron.service.domain.rollouts.states import RolloutState
from rtron.vocabulary import SECOND, GuardEventLevel

ROLLOUT = "rollout"
"""The type of the live message, and the kind of the alert."""
_GOING_BACK = frozenset({RolloutState.REVERTING, RolloutState.REVERTED})
_MAX_LENGTH = 1000


def going_back_alert(id: int, before: RolloutState, state: RolloutState, note: str) -> str:
    """Return that a roll-out which nobody takes back goes back, and why; "" if it does not."""
    if before in _GOING_BACK or state not in _GOING_BACK:
        return ""
    return f"roll-out {id} goes back by itself: {note}"[:_MAX_LENGTH]


def rollout_message(id: int, alert: str = "") -> dict[str, Any]:
    """Return the live message that something of a roll-out is new; `alert` if it is that bad."""
    return {"type": ROLLOUT, "id": id, "alert": alert}


def alert_event(message: Mapping[str, Any], now: int) -> dict[str, Any]:
    """Return an alert at `now` (ns), with the keys of a robot's event; it is of no robot."""
    texts = "robot", "topic", "flow", "publisher", "policy", "decision"
    return {
        **dict.fromkeys(texts, ""),
        "id": 0,
        "at": now,
        "kind": ROLLOUT,
        "node": f"rollout/{message['id']}",
        "level": GuardEventLevel.ERROR.value,
        "reason": message["alert"],
        "revision": 0,
        "values": {},
    }


class RolloutNews:
    """Finds out which roll-outs show something new, each once a second at most; time passed in."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Hashable, int]] = {}

    def is_new(self, id: int, shown: Hashable, now: int) -> bool:
        """Tell whether a roll-out shows something else than when it was new last, at `now` (ns).

        What changes within a second of that is new later, as long as it is looked at.
        """
        before, at = self._known.get(id, (None, now - SECOND))
        if shown == before or abs(now - at) < SECOND:
            return False
        self._known[id] = shown, now
        return True

    def take_ended(self, unfinished: Collection[int]) -> Sequence[int]:
        """Return the roll-outs that have come to an end since the last time: that is new, too."""
        ended = sorted(self._known.keys() - set(unfinished))
        for id in ended:
            del self._known[id]
        return ended

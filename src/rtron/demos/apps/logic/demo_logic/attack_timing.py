"""When a malicious node attacks: some time after the robot set off in the run of the order."""

from collections.abc import Sequence
from typing import Protocol

from .attack_trigger import AttackOrder, TriggerFile

_BURST = 0.3
"""Simulated seconds that a burst lasts, and the pause after it."""


class MotionDetector(Protocol):
    """Detects from a node's messages that the robot has set off."""

    def reset(self) -> None:
        """Start again."""

    def has_moved(self, reading: Sequence[float], /) -> bool:
        """Take a position or the ranges of a scan (metres)."""


class Attacker:
    """Decides when it is time to attack."""

    def __init__(self, motion: MotionDetector, trigger: TriggerFile | None = None) -> None:
        self._motion = motion
        self._trigger = trigger or TriggerFile()
        self._order: AttackOrder | None = None
        self._since: float | None = None

    def observe(self, now: float, reading: Sequence[float]) -> None:
        """Take a position or a scan that the node received at `now`, simulated seconds."""
        self._reread()
        moved = self._motion.has_moved(reading)
        self._since = (now if self._since is None else self._since) if moved else None

    def due_attack(self, now: float, attack: str) -> AttackOrder | None:
        """Return the order if it is for this attack and its time has come."""
        self._reread()
        order, since = self._order, self._since  # another thread may be in `observe`
        if order is None or since is None or order.attack != attack:
            return None
        return order if now - since >= order.after else None

    def _reread(self) -> None:
        order = self._trigger.order()
        if order != self._order:
            self._order, self._since = order, None
            self._motion.reset()


def in_burst(now: float) -> bool:
    """Tell whether commands that turn the robot are sent at `now`, simulated seconds.

    Their forward velocity is 0, so that without pauses the robot would only turn on the spot. In
    the pauses the navigation itself drives it on, off its course, and has no time to turn it back.
    Attackers on one machine have their bursts together.
    """
    return now % (2 * _BURST) < _BURST

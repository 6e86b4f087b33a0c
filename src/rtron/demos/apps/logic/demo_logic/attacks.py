"""How a malicious node attacks: on an order, some time after the robot has set off."""

import json
import os
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, copysign, hypot
from pathlib import Path
from typing import Protocol

from .geometry import Point, Pose, Velocity, clamp, wrap_angle


@dataclass(frozen=True)
class AttackOrder:
    """Which attack, and how many simulated seconds after the robot set off."""

    attack: str
    after: float
    goal: tuple[float, float] | None
    run: int


def read_order(path: str, machine: int) -> AttackOrder | None:
    """Return the order in the file that DEMO_TRIGGER names; None if it is for another machine."""
    try:
        written = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError:
        return None  # a malicious node stays hidden: it reports no error
    if int(written["mac"].replace(":", ""), 16) != machine:
        return None
    goal = tuple(written["goal"]) if written["goal"] else None
    return AttackOrder(written["attack"], written["after"], goal, written["run"])


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

    def __init__(
        self, motion: MotionDetector, trigger: str = "", machine: int | None = None
    ) -> None:
        self._motion = motion
        self._trigger = trigger or os.environ.get("DEMO_TRIGGER", "")
        self._machine = uuid.getnode() if machine is None else machine
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
        order = read_order(self._trigger, self._machine)
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


_CARRIED = 0.5
_MOVED = 0.05
_CHANGED, _CHANGED_SHARE = 0.04, 0.15


class OdometryMotion:
    """Detects from positions that the robot has left the point where it stood."""

    def __init__(self) -> None:
        self._from: tuple[float, float] | None = None
        self._last = (0.0, 0.0)

    def reset(self) -> None:
        """Start again at the next position."""
        self._from = None

    def has_moved(self, position: Sequence[float]) -> bool:
        """Take a position (metres); a robot that was carried elsewhere stands there anew."""
        x, y = position
        if self._from is None or hypot(x - self._last[0], y - self._last[1]) > _CARRIED:
            self._from = (x, y)
        self._last = (x, y)
        return hypot(x - self._from[0], y - self._from[1]) > _MOVED


class ScanMotion:
    """Detects it from scans: many rays have another length than where the robot stood."""

    def __init__(self) -> None:
        self._from: Sequence[float] | None = None
        self._moved = False

    def reset(self) -> None:
        """Start again at the next scan."""
        self._from, self._moved = None, False

    def has_moved(self, ranges: Sequence[float]) -> bool:
        """Take the ranges of a scan (metres); true from the first that differs, until `reset`."""
        if self._from is None or len(self._from) != len(ranges):
            self._from = ranges
        if not self._moved:
            changed = sum(abs(a - b) > _CHANGED for a, b in zip(self._from, ranges, strict=True))
            self._moved = changed > _CHANGED_SHARE * len(ranges)
        return self._moved


FAST = 0.8
"""m/s, where the robot is allowed 0.22."""
TURN = 1.2
"""rad/s."""
_CORRECTION = 0.1


class ShortCut:
    """A short cut to a place, begun at a pose at `now` (simulated seconds).

    It turns for as long as that takes. On the straight it corrects its course only a little, so
    that the commands by themselves lead to the place, also where nothing obeys them.
    """

    def __init__(self, pose: Pose, place: Point, now: float) -> None:
        self._place = place
        aside = _aside(pose, place)
        self._turn = copysign(TURN, aside)
        self._straight_from = now + abs(aside) / TURN

    def velocity(self, pose: Pose, now: float) -> Velocity:
        """Return the command at `now` from the pose that the robot has."""
        if now < self._straight_from:
            return 0.0, self._turn
        return FAST, clamp(_aside(pose, self._place), _CORRECTION)


def _aside(pose: Pose, place: Point) -> float:
    """Return how far to the left of its heading a robot has a place, rad."""
    return wrap_angle(atan2(place[1] - pose[1], place[0] - pose[0]) - pose[2])

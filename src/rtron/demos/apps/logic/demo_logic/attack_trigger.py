"""The file that says when a malicious node attacks, and on which machine."""

import json
import os
import uuid
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

ATTACKS = ("gr", "rsr", "msr", "agent")
_Version = tuple[int, int, int]


@dataclass(frozen=True)
class AttackOrder:
    """Which attack, and how many simulated seconds after the robot set off."""

    attack: str
    after: float
    goal: tuple[float, float] | None
    run: int


class TriggerFile:
    """The file that DEMO_TRIGGER names; read again whenever it changes."""

    def __init__(self, path: str | None = None, machine: int | None = None) -> None:
        path = path or os.environ.get("DEMO_TRIGGER")
        self._path = Path(path) if path else None
        self._machine = uuid.getnode() if machine is None else machine
        self._version: _Version | None = None
        self._order: AttackOrder | None = None

    def order(self) -> AttackOrder | None:
        """Return the order for this machine; None without a valid one."""
        version = self._version_now()
        if version != self._version:
            self._version = version
            self._order = self._read() if version else None
        return self._order

    def _version_now(self) -> _Version | None:
        try:
            status = self._path.stat() if self._path else None
        except OSError:
            return None
        return (status.st_mtime_ns, status.st_size, status.st_ino) if status else None

    def _read(self) -> AttackOrder | None:
        try:
            written = json.loads(self._path.read_text(encoding="utf-8")) if self._path else {}
            return read_order(written) if _machine(written) == self._machine else None
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            return None  # a malicious node stays hidden: it reports no error


def read_order(written: dict[str, object]) -> AttackOrder | None:
    """Return the order in a trigger file's object, None for no attack; ValueError or the like."""
    attack, after, goal = written["attack"], written["after"], written.get("goal")
    if attack not in ATTACKS or not isinstance(after, (int, float)) or not isfinite(after):
        return None
    return AttackOrder(str(attack), float(after), _point(goal), int(str(written.get("run", 0))))


def _machine(written: dict[str, str]) -> int:
    return int(str(written["mac"]).replace(":", ""), 16)


def _point(value: object) -> tuple[float, float] | None:
    if value is None:
        return None
    if not isinstance(value, list):
        raise TypeError("a goal is a list")
    x, y = map(float, value)
    if not (isfinite(x) and isfinite(y)):
        raise ValueError("a goal is finite")
    return x, y

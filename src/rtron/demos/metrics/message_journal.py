"""What the nodes of the app wrote down: malicious messages sent, and what arrived where it acts."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from rtron.errors import SourceError

IsMalicious = Callable[[str, Sequence[float]], bool]
"""Tells by its topic and value whether a message that arrived is malicious."""


@dataclass(frozen=True, slots=True)
class JournalEntry:
    """A message that was sent or received at `wall` (s since 1970)."""

    wall: float
    node: str
    topic: str
    value: tuple[float, ...]
    sent: bool


def read_journal(folder: Path, since: float = 0.0, until: float = inf) -> tuple[JournalEntry, ...]:
    """Return what was written from `since` until `until` (wall s), in the order of time.

    A last line that is not whole yet is left for later; SourceError for any other that is wrong.
    """
    found = (entry for path in sorted(folder.glob("*.jsonl")) for entry in _entries(path))
    return tuple(sorted((e for e in found if since <= e.wall <= until), key=lambda e: e.wall))


def _entries(path: Path) -> Iterator[JournalEntry]:
    complete_lines, _, _ = path.read_text(encoding="utf-8").rpartition("\n")
    try:
        yield from (_entry(path.stem, json.loads(line)) for line in complete_lines.splitlines())
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise SourceError(f"{path} is no journal: {error}") from None


def _entry(node: str, written: Mapping[str, Any]) -> JournalEntry:
    value = tuple(float(each) for each in written["value"])
    sent = {"sent": True, "received": False}[written["what"]]
    return JournalEntry(float(written["wall"]), node, written["topic"], value, sent)


@dataclass(frozen=True, slots=True)
class Attack:
    """The malicious messages of a run: when they were sent and when they arrived (wall s)."""

    sent: tuple[float, ...] = ()
    delivered: tuple[float, ...] = ()

    @property
    def began(self) -> float | None:
        """When the first was sent; None without an attack."""
        return self.sent[0] if self.sent else None


def attack_messages(entries: Sequence[JournalEntry], is_malicious: IsMalicious) -> Attack:
    """Return the attack that a journal tells of; nodes note only malicious messages as sent."""
    sent = tuple(each.wall for each in entries if each.sent)
    arrived = (each for each in entries if not each.sent)
    delivered = tuple(each.wall for each in arrived if is_malicious(each.topic, each.value))
    return Attack(sent, delivered)


def time_to_mitigation(attack: Attack, stopped: float | None) -> float | None:
    """Return the wall s from an attack's first message to the verdict that stopped one first.

    None without an attack, or where no verdict tells when (`stopped` is None).
    """
    if attack.began is None or stopped is None:
        return None
    return max(0.0, stopped - attack.began)

"""What the nodes of the app wrote down: malicious messages sent, and what arrived where it acts."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import dist
from pathlib import Path
from typing import Any

import shapely

from rtron.demos.world.ground_truth import Position

IsMalicious = Callable[[str, Sequence[float]], bool]
"""Tells by its topic and value whether a message that arrived is malicious."""


@dataclass(frozen=True, slots=True)
class Attack:
    """The malicious messages of a run: when they were sent and when they arrived (wall s)."""

    sent: tuple[float, ...] = ()
    delivered: tuple[float, ...] = ()


def read_attack(folder: Path, times: tuple[float, float], is_malicious: IsMalicious) -> Attack:
    """Return the attack that the nodes' journals tell of, from a wall time until another (s).

    Nodes note only malicious messages as sent. A last line that is not whole yet is left out.
    """
    entries = [
        entry
        for path in folder.glob("*.jsonl")
        for entry in _complete_entries(path)
        if times[0] <= entry["wall"] <= times[1]
    ]
    sent = [each["wall"] for each in entries if each["what"] == "sent"]
    arrived = [each for each in entries if each["what"] == "received"]
    delivered = [e["wall"] for e in arrived if is_malicious(e["topic"], tuple(e["value"]))]
    return Attack(tuple(sorted(sent)), tuple(sorted(delivered)))


def _complete_entries(path: Path) -> Iterator[Mapping[str, Any]]:
    complete_lines, _, _ = path.read_text(encoding="utf-8").rpartition("\n")
    return map(json.loads, complete_lines.splitlines())


_STEP = 0.02
"""Places of a way nearer to each other than this (m) count as one: a rest does not weigh."""


@dataclass(frozen=True, slots=True)
class TrajectoryDeviation:
    """The largest and the mean distance (m) of a way's places from another way."""

    largest: float
    mean: float


def measure_deviation(
    trajectory: Sequence[Position], reference: Sequence[Position]
) -> TrajectoryDeviation | None:
    """Return the distances of `trajectory` from the line `reference`; None if either is empty."""
    if not trajectory or not reference:
        return None
    line = shapely.LineString([*reference, reference[-1]])
    distances = shapely.distance(line, shapely.points(_without_rests(trajectory)))
    return TrajectoryDeviation(float(distances.max()), float(distances.mean()))


def _without_rests(trajectory: Sequence[Position]) -> list[Position]:
    thinned = [trajectory[0]]
    for position in trajectory:
        if dist(position, thinned[-1]) >= _STEP:
            thinned.append(position)
    return thinned

"""The lines of what XML and YAML files start: launch does not keep them, reading the file does."""

from collections import defaultdict
from dataclasses import replace
from typing import TypeAlias

from rtron.sources.launch.ros2.result import AppLaunch, Start
from rtron.vocabulary import Evidence

_Key: TypeAlias = tuple[str, str, str, str, str]


def with_lines(executed: AppLaunch, read: AppLaunch) -> AppLaunch:
    """Return what was executed, with the lines that are known from reading the same file."""
    places: dict[_Key, set[Evidence]] = defaultdict(set)
    for start in read.starts:
        places[_key(start)].add(start.evidence)
    return replace(executed, starts=tuple(_placed(start, places) for start in executed.starts))


def _placed(start: Start, places: dict[_Key, set[Evidence]]) -> Start:
    found = places.get(_key(start), set()) if not start.evidence.line else set()
    return replace(start, evidence=next(iter(found))) if len(found) == 1 else start


def _key(start: Start) -> _Key:
    return start.kind, start.package, start.program, start.name, start.evidence.file

"""The lines of what XML and YAML files start: launch does not keep them, reading the file does."""

from collections import defaultdict
from dataclasses import replace
from typing import TypeAlias

from rtron.sources.launch.ros2.result import AppLaunch, LaunchStart
from rtron.vocabulary import Evidence

_Key: TypeAlias = tuple[str, str, str, str, str]


def add_lines(executed: AppLaunch, read: AppLaunch) -> AppLaunch:
    """Return what was executed, with the lines that are known from reading the same file."""
    locations: dict[_Key, set[Evidence]] = defaultdict(set)
    for start in read.starts:
        locations[_key(start)].add(start.evidence)
    return replace(
        executed, starts=tuple(_with_line(start, locations) for start in executed.starts)
    )


def _with_line(start: LaunchStart, locations: dict[_Key, set[Evidence]]) -> LaunchStart:
    matches = locations.get(_key(start), set()) if not start.evidence.line else set()
    return replace(start, evidence=next(iter(matches))) if len(matches) == 1 else start


def _key(start: LaunchStart) -> _Key:
    return start.kind, start.package, start.program, start.name, start.evidence.file

"""The launch files that `rtron scan PATH` can analyse."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.text import Text

    from rtron.reports.text_layout import Report
    from rtron.sources.launch.common.launch_file import LaunchFileInfo


LAUNCHES_SCHEMA = "rtron.launches/1"


def launch_list_text(launches: "Mapping[str, LaunchFileInfo]", folders: Sequence[Path]) -> "Report":
    """Return the launch files with their arguments, and the command that scans one."""
    from rtron.reports.text_layout import Report

    return Report(lambda _: _lines(launches, folders))


def launch_list_to_json(found: "Mapping[str, LaunchFileInfo]") -> dict[str, object]:
    """Return the launch files as a JSON document."""
    launches = [
        {
            "launch": name,
            "path": str(each.path),
            "package": each.package,
            "required": list(each.required),
            "optional": list(each.optional),
            "error": each.error,
        }
        for name, each in found.items()
    ]
    return {"schema": LAUNCHES_SCHEMA, "launches": launches}


def _lines(found: "Mapping[str, LaunchFileInfo]", folders: Sequence[Path]) -> "list[Text]":
    from rtron.reports.text_layout import columns, counted, line

    rows = [(name, _argument_text(each)) for name, each in found.items()]
    arguments = [
        *map(str, folders),
        "--launch",
        min(found, key=lambda name: _unlikeliness(name, found[name])),
    ]
    return [
        line((counted(len(found), "launch file"), "bold")),
        *columns(rows, ("cyan", "dim"), indent=2),
        line(),
        line("next  ", ("rtron scan " + " ".join(map(quote, arguments)), "bold")),
    ]


def _argument_text(launch: "LaunchFileInfo") -> str:
    if launch.error:
        return "cannot be read"
    required = [f"{name}:=…" for name in launch.required]
    return " ".join((*required, *(f"[{name}:=…]" for name in launch.optional)))


_LIKELY = ("bringup", "navigation", "nav2", "navigate", "robot", "core", "main", "demo", "start")
"""Words in the names of launch files that start a whole app, the likeliest first."""
_PARTS = ("test", "rviz", "teleop", "description", "upload", "calibrat", "spawn", "example")
"""Words in the names of those that start a part of one, or a tool."""


def _unlikeliness(name: str, launch: "LaunchFileInfo") -> tuple[bool, bool, int, int, str]:
    """Return how far a launch file is from being the one that starts the app, the least first.

    Its own name counts before its package's, and of two the one that includes more.
    """
    file = launch.path.name.lower()
    words = [i for i, word in enumerate(_LIKELY) if word in file]
    in_package = [i for i, word in enumerate(_LIKELY) if word in launch.package.lower()]
    likely = min(words, default=len(_LIKELY) + min(in_package, default=len(_LIKELY)))
    is_part = any(word in file for word in _PARTS)
    return bool(launch.error), is_part, likely, len(launch.required) - len(launch.includes), name

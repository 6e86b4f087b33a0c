"""The launch files that `rtron scan PATH` can analyse."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from shlex import quote

from rich.text import Text

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import as_json
from rtron.errors import InputError
from rtron.reports.text_layout import Report, columns, counted, line
from rtron.sources.launch.ros1.file_search import LaunchFileInfo
from rtron.workflows.launch_listing import launches_by_name

LAUNCHES_SCHEMA = "rtron.launches/1"


def list_launches(folders: Sequence[Path], format: TextOrJson) -> str | Report:
    """Return the launch files below folders; raise InputError if there are none."""
    found = launches_by_name(folders)
    if not found:
        help = "give the folder of a ROS workspace, or of a package"
        raise InputError("no launch files", path=str(folders[0]), help=help)
    if format is TextOrJson.JSON:
        return as_json(_document(found))
    return Report(lambda _: _lines(found, folders))


def _document(found: Mapping[str, LaunchFileInfo]) -> dict[str, object]:
    launches = [
        {
            "launch": name,
            "path": str(each.path),
            "package": each.package,
            "required": list(each.required),
            "optional": list(each.optional),
            "fault": each.error,
        }
        for name, each in found.items()
    ]
    return {"schema": LAUNCHES_SCHEMA, "launches": launches}


def _lines(found: Mapping[str, LaunchFileInfo], folders: Sequence[Path]) -> list[Text]:
    rows = [(name, _argument_text(each)) for name, each in found.items()]
    arguments = [
        *map(str, folders),
        "--launch",
        min(found, key=lambda name: _sort_key(found[name])),
    ]
    return [
        line((counted(len(found), "launch file"), "bold")),
        *columns(rows, ("cyan", "dim"), indent=2),
        line(),
        line("next  ", ("rtron scan " + " ".join(map(quote, arguments)), "bold")),
    ]


def _argument_text(launch: LaunchFileInfo) -> str:
    if launch.error:
        return "cannot be read"
    required = [f"{name}:=…" for name in launch.required]
    return " ".join((*required, *(f"[{name}:=…]" for name in launch.optional)))


def _sort_key(launch: LaunchFileInfo) -> tuple[bool, int]:
    return bool(launch.error), len(launch.required)

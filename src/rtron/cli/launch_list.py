"""The launch files that `rtron scan PATH` can analyse."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from shlex import quote

from rich.text import Text

from rtron.cli.launch_names import named_launches
from rtron.cli.options import TextOrJson
from rtron.cli.outcome import as_json
from rtron.errors import InputError
from rtron.reports.text_layout import Report, columns, counted, line
from rtron.sources.launch.listing import ListedLaunch

LAUNCHES_SCHEMA = "rtron.launches/1"


def listed_launches(folders: Sequence[Path], format: TextOrJson) -> str | Report:
    """Return the launch files below folders; raise InputError if there are none."""
    found = named_launches(folders)
    if not found:
        help = "give the folder of a ROS workspace, or of a package"
        raise InputError("no launch files", path=str(folders[0]), help=help)
    if format is TextOrJson.JSON:
        return as_json(_document(found))
    return Report(lambda _: _lines(found, folders))


def _document(found: Mapping[str, ListedLaunch]) -> dict[str, object]:
    launches = [
        {
            "launch": name,
            "path": str(each.path),
            "package": each.package,
            "required": list(each.required),
            "optional": list(each.optional),
            "fault": each.fault,
        }
        for name, each in found.items()
    ]
    return {"schema": LAUNCHES_SCHEMA, "launches": launches}


def _lines(found: Mapping[str, ListedLaunch], folders: Sequence[Path]) -> list[Text]:
    rows = [(name, _needs(each)) for name, each in found.items()]
    words = [*map(str, folders), "--launch", min(found, key=lambda name: _ease(found[name]))]
    return [
        line((counted(len(found), "launch file"), "bold")),
        *columns(rows, ("cyan", "dim"), indent=2),
        line(),
        line("next  ", ("rtron scan " + " ".join(map(quote, words)), "bold")),
    ]


def _needs(launch: ListedLaunch) -> str:
    if launch.fault:
        return "cannot be read"
    required = [f"{name}:=…" for name in launch.required]
    return " ".join((*required, *(f"[{name}:=…]" for name in launch.optional)))


def _ease(launch: ListedLaunch) -> tuple[bool, int]:
    return bool(launch.fault), len(launch.required)

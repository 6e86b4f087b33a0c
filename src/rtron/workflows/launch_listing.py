"""The launch files below folders, by the names that `--launch` takes."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from rtron.errors import RTronError

if TYPE_CHECKING:
    from rtron.sources.launch.ros1.file_search import LaunchFileInfo


def launch_name(launch: "LaunchFileInfo") -> str:
    """Return `package/file`, or the path of a file that lies in no package."""
    return f"{launch.package}/{launch.path.name}" if launch.package else str(launch.path)


def launches_by_name(folders: Iterable[Path]) -> dict[str, "LaunchFileInfo"]:
    """Return the launch files by name; those of a package that share a name, by path."""
    from rtron.sources.launch.ros1.file_search import find_launch_files  # noqa: PLC0415 - the guard starts without
    from rtron.sources.launch.ros2.file_search import list_ros2_launch_files  # noqa: PLC0415

    folders = list(folders)
    found = {
        each.path: each for each in (*find_launch_files(folders), *list_ros2_launch_files(folders))
    }
    counted = Counter(map(launch_name, found.values()))
    return {
        launch_name(each) if counted[launch_name(each)] == 1 else str(each.path): each
        for each in found.values()
    }


def complete_launch(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the names of launch files for a shell's completion."""
    inputs = ctx.params.get("inputs") or ctx.args or ["."]
    folders = [Path(word) for word in inputs if Path(word).is_dir()]
    try:
        names = launches_by_name(folders)
    except (RTronError, OSError):
        return []
    return [name for name in names if name.startswith(incomplete)]

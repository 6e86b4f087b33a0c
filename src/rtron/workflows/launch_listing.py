"""The launch files below folders, by the names that `--launch` takes."""

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from rtron.errors import RTronError

if TYPE_CHECKING:
    from rtron.sources.launch.ros1.file_search import ListedLaunch


def launch_name(launch: "ListedLaunch") -> str:
    """Return `package/file`, or the path of a file that lies in no package."""
    return f"{launch.package}/{launch.path.name}" if launch.package else str(launch.path)


def named_launches(folders: Iterable[Path]) -> dict[str, "ListedLaunch"]:
    """Return the launch files by name; those of a package that share a name, by path."""
    from rtron.sources.launch.ros1.file_search import launch_files  # noqa: PLC0415 - the guard starts without
    from rtron.sources.launch.ros2.file_search import ros2_launches  # noqa: PLC0415

    folders = list(folders)
    found = {each.path: each for each in (*launch_files(folders), *ros2_launches(folders))}
    counted = Counter(map(launch_name, found.values()))
    return {
        launch_name(each) if counted[launch_name(each)] == 1 else str(each.path): each
        for each in found.values()
    }


def complete_launch(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the names of launch files for a shell's completion."""
    words = ctx.params.get("inputs") or ctx.args or ["."]
    folders = [Path(word) for word in words if Path(word).is_dir()]
    try:
        names = named_launches(folders)
    except (RTronError, OSError):
        return []
    return [name for name in names if name.startswith(incomplete)]

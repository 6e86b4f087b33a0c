"""Which launch files of ROS 2 folders hold (docs.ros.org: launch file formats)."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import IGNORE_MARKERS, walk
from rtron.sources.launch.common.file_format import is_ros2_launch_file

MAX_FOLDERS = 200_000

_SKIPPED_FOLDERS = frozenset({".git", ".hg", ".svn", "build", "install", "log"})


def find_ros2_launch_files(folders: Iterable[Path]) -> tuple[Path, ...]:
    """Return the launch files of ROS 2 below folders, by path; links are not followed.

    What builds leave out has none. A Python file is one if it defines what launch calls, or names
    it and is called so. Raise InputError for a folder without end.
    """
    return tuple(
        sorted({path for folder in folders for path in _launch_files_below(folder.absolute())})
    )


def _launch_files_below(top: Path) -> Iterator[Path]:
    for count, (folder, subfolders, files) in enumerate(walk(top, lambda path, why: None)):
        if count == MAX_FOLDERS:
            raise InputError(f"has more than {MAX_FOLDERS} folders", path=str(top))
        if not IGNORE_MARKERS.isdisjoint(files):
            subfolders.clear()
            continue
        subfolders[:] = [name for name in subfolders if name not in _SKIPPED_FOLDERS]
        yield from (path for name in files if is_ros2_launch_file(path := Path(folder, name)))

"""Which files `ros2 launch` opens (docs.ros.org: launch file formats)."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import IGNORE_MARKERS, walk
from rtron.sources.bounded_file import read_bounded

MAX_FOLDERS = 200_000
MAX_BYTES = 2**20

_SUFFIXES = ("launch.xml", "launch.yaml", "launch.yml")
_PYTHON_SUFFIX = "launch.py"
_ENTRY_FUNCTION = b"generate_launch_description"
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


def is_ros2_launch_file(path: Path) -> bool:
    """Return whether a file is a launch file of ROS 2, by its name or by what it defines."""
    if path.name.endswith(_SUFFIXES):
        return True
    if path.suffix != ".py" or not path.is_file():
        return False
    try:
        text = read_bounded(path, MAX_BYTES)
    except InputError:
        return False
    named = path.name.endswith(_PYTHON_SUFFIX)
    return (_ENTRY_FUNCTION if named else b"def " + _ENTRY_FUNCTION) in text

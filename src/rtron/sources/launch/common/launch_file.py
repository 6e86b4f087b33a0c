"""Launch files below a folder: the ROS of each, and the arguments that it declares.

docs.ros.org: launch file formats; REP 149: build types.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import IGNORE_MARKERS, walk
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.packages import build_types, package_folder
from rtron.sources.launch.common.xml_document import Element, parse_launch, parse_xml

_ROS2_SUFFIXES = frozenset({".py", ".yaml", ".yml"})
_ROS2_ELEMENTS = frozenset({"executable", "let", "node_container", "push-ros-namespace"})


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchFileInfo:
    """A launch file: the package it lies in, empty where it lies in none, and its arguments.

    `required` are those without a value or default, `optional` those with a default. `includes` are
    the files that it includes, as they are spelled. `error` says why a file, or a folder in which
    there may be some, cannot be read.
    """

    path: Path
    package: str = ""
    required: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    includes: tuple[str, ...] = ()
    error: str = ""


def launch_generation(launch: Path) -> int:
    """Return 2 for a launch file of ROS 2, else 1.

    Python and YAML are of ROS 2. XML tells it by its elements; where it does not, by the build type
    of the package that it lies in.
    """
    if launch.suffix in _ROS2_SUFFIXES:
        return 2
    try:
        if is_ros2(parse_launch(str(launch)).launch):
            return 2
    except InputError:
        pass  # unreadable: the package around it tells its generation
    return 2 if _is_in_ament_package(launch.absolute()) else 1


def is_ros2(launch: Element) -> bool:
    """Tell whether a launch file has elements or attributes that ROS 2 alone has."""
    return any(_is_ros2(element) for element in launch.iter("*"))


def _is_ros2(element: Element) -> bool:
    if element.tag in _ROS2_ELEMENTS or (element.tag == "node" and element.get("exec") is not None):
        return True
    return any("$(var " in str(value) or "$(find-pkg-" in str(value) for value in element.values())


def _is_in_ament_package(path: Path) -> bool:
    package = package_folder(path)
    if package is None:
        return False
    try:
        root = parse_xml(package / "package.xml")
    except InputError:
        return False
    return any(build.startswith("ament_") for build in build_types(root))


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

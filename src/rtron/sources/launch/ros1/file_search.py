"""Which launch files of ROS 1 a folder holds, and what arguments each needs."""

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import SkipHandler, walk
from rtron.sources.launch.common.packages import package_name
from rtron.sources.launch.common.xml_document import Element, parse_launch

MAX_FOLDERS = 200_000

_SUFFIXES = (".launch", ".launch.xml")
_SKIPPED_FOLDERS = frozenset({".git", ".hg", ".svn"})
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


def find_launch_files(folders: Iterable[Path]) -> tuple[LaunchFileInfo, ...]:
    """Return the launch files of ROS 1 below folders, by path; those of ROS 2 are left out.

    Links are not followed. Raise InputError for a folder that has no end.
    """
    packages_by_path: dict[Path, str] = {}
    errors: list[LaunchFileInfo] = []

    def unread(folder: str, why: str) -> None:
        errors.append(LaunchFileInfo(path=Path(folder), error=f"{folder}: {why}"))

    for folder in folders:
        packages_by_path.update(_launch_files_below(folder.absolute(), unread))
    listed = (
        _launch_file_info(path, package) for path, package in sorted(packages_by_path.items())
    )
    return (*(launch for launch in listed if launch is not None), *errors)


def _launch_files_below(top: Path, unreadable: SkipHandler) -> Iterator[tuple[Path, str]]:
    packages: dict[str, str] = {}
    for folder, subfolders, files in walk(top, unreadable):
        if len(packages) == MAX_FOLDERS:
            raise InputError(f"has more than {MAX_FOLDERS} folders", path=str(top))
        package = packages.get(os.path.dirname(folder), "")  # noqa: PTH120 - a key, as os.walk spells it
        if "package.xml" in files:
            package = package_name(Path(folder))
        packages[folder] = package
        subfolders[:] = [name for name in subfolders if name not in _SKIPPED_FOLDERS]
        yield from ((Path(folder, name), package) for name in files if name.endswith(_SUFFIXES))


def _launch_file_info(path: Path, package: str) -> LaunchFileInfo | None:
    try:
        launch = parse_launch(str(path)).launch
    except InputError as error:
        return LaunchFileInfo(path=path, package=package, error=str(error))
    if is_ros2(launch):
        return None
    arguments = [tag for tag in launch.iterchildren("arg") if tag.get("value") is None]
    optional = {str(tag.get("name")) for tag in arguments if tag.get("default") is not None}
    names = dict.fromkeys(str(tag.get("name")) for tag in arguments)
    return LaunchFileInfo(
        path=path,
        package=package,
        required=tuple(name for name in names if name not in optional),
        optional=tuple(name for name in names if name in optional),
        includes=tuple(str(tag.get("file")) for tag in launch.iter("include")),
    )


def is_ros2(launch: Element) -> bool:
    """Tell whether a launch file has elements or attributes that ROS 2 alone has."""
    return any(_is_ros2(element) for element in launch.iter("*"))


def _is_ros2(element: Element) -> bool:
    if element.tag in _ROS2_ELEMENTS or (element.tag == "node" and element.get("exec") is not None):
        return True
    return any("$(var " in str(value) or "$(find-pkg-" in str(value) for value in element.values())

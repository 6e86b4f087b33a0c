"""Which launch files of ROS 1 a folder holds, and what arguments each needs."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import IGNORE_MARKERS, SkipHandler, walk
from rtron.sources.launch.common.launch_file import LaunchFileInfo, is_ros2
from rtron.sources.launch.common.packages import package_name
from rtron.sources.launch.common.xml_document import parse_launch

MAX_FOLDERS = 200_000

_SUFFIXES = (".launch", ".launch.xml")
_SKIPPED_FOLDERS = frozenset({".git", ".hg", ".svn"})


def find_launch_files(folders: Iterable[Path]) -> tuple[LaunchFileInfo, ...]:
    """Return the launch files of ROS 1 below folders, by path; those of ROS 2 are left out.

    Links are not followed, and what builds leave out has none. Raise InputError for a folder that
    has no end.
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
        if not IGNORE_MARKERS.isdisjoint(files):
            subfolders.clear()
            continue
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

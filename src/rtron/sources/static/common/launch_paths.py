"""Which file `roslaunch` or `ros2 launch` would open.

ROS wiki: roslaunch/Commandline Tools; docs.ros.org: "Launching nodes".
"""

import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.launch.common.launch_file import is_ros2_launch_file
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.package_files import PackageFiles, is_regular, list_files

LaunchRequest: TypeAlias = tuple[Path, Mapping[str, str]]
"""A launch file, and the arguments that it gets."""
_MAX_SUGGESTIONS = 3
_PACKAGE = re.compile(r"\w[\w.-]*")
_SUFFIXES = (".launch", "launch.xml", "launch.py", "launch.yaml", "launch.yml")


def find_launch_file(
    path_text: str, workspace: Workspace, environ: Mapping[str, str] = MappingProxyType({})
) -> Path:
    """Return the launch file that a path or `package/file` means.

    In a package it may lie in any folder. A package that is not in the workspace is looked for
    below AMENT_PREFIX_PATH. Raise InputError, with the nearest names, if there is none.
    """
    path = (
        _as_path(path_text) or _in_package(path_text, workspace) or _installed(path_text, environ)
    )
    if path is not None:
        return path
    suggestions = get_close_matches(
        path_text, _launch_file_names(workspace), n=_MAX_SUGGESTIONS, cutoff=0.5
    )
    help = (
        f"did you mean {' or '.join(suggestions)}?"
        if suggestions
        else "rtron scan PATH lists launch files"
    )
    raise InputError(f"no launch file {path_text}", help=help)


def is_launch_file(path: Path) -> bool:
    """Return whether a path leads to a launch file, by its name or by what it defines."""
    return is_regular(path) and (path.name.endswith(_SUFFIXES) or is_ros2_launch_file(path))


def _as_path(path_text: str) -> Path | None:
    path = Path(path_text)
    return path.absolute() if is_regular(path) else None


def _in_package(path_text: str, workspace: Workspace) -> Path | None:
    package, _, rest = path_text.partition("/")
    if not rest or package not in workspace.packages:
        return None
    return _shallowest(workspace.files(package), rest)


def _installed(path_text: str, environ: Mapping[str, str]) -> Path | None:
    """Return a file in the share folder of an installed package, which may be a link to its source.

    The first prefix that has the package counts (ament_index_python: get_package_share_directory).
    """
    package, _, rest = path_text.partition("/")
    if not (rest and _PACKAGE.fullmatch(package)):
        return None
    for prefix in filter(None, environ.get("AMENT_PREFIX_PATH", "").split(":")):
        share = Path(prefix).absolute() / "share" / package
        if path_exists(share) and share.is_dir():
            return _shallowest(list_files(share, (Path("/"),)), rest)
    return None


def _shallowest(files: PackageFiles, rest: str) -> Path | None:
    """Return the file with this path's end that lies in the fewest folders."""
    paths = (path for path in files.files_named(Path(rest).name) if str(path).endswith(f"/{rest}"))
    return min(filter(files.is_file, paths), key=_depth, default=None)


def _depth(path: Path) -> tuple[int, str]:
    return len(path.parts), str(path)


def _launch_file_names(workspace: Workspace) -> Iterable[str]:
    return [
        f"{package}/{Path(name).name}"
        for package in workspace.packages
        for name in workspace.files(package).names
        if name.endswith(_SUFFIXES)
    ]

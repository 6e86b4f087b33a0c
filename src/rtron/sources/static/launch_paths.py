"""Which file `roslaunch` or `ros2 launch` would open.

ROS wiki: roslaunch/Commandline Tools; docs.ros.org: "Launching nodes".
"""

from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.workspace import Workspace
from rtron.sources.workspace.files import is_regular

_MAX_NEAR = 3
_ENDINGS = (".launch", "launch.xml", "launch.py", "launch.yaml", "launch.yml")


def find_launch(spelled: str, workspace: Workspace) -> Path:
    """Return the launch file that a path or `package/file` means.

    In a package it may lie in any folder. Raise InputError, with the nearest names, if there is
    none.
    """
    found = _as_path(spelled) or _in_package(spelled, workspace)
    if found is not None:
        return found
    near = get_close_matches(spelled, _names(workspace), n=_MAX_NEAR, cutoff=0.5)
    help = f"did you mean {' or '.join(near)}?" if near else "rtron scan PATH lists launch files"
    raise InputError(f"no launch file {spelled}", help=help)


def _as_path(spelled: str) -> Path | None:
    path = Path(spelled)
    return path.absolute() if is_regular(path) else None


def _in_package(spelled: str, workspace: Workspace) -> Path | None:
    package, _, rest = spelled.partition("/")
    if not rest or package not in workspace.packages:
        return None
    files = workspace.files(package)
    ending = f"/{rest}"
    paths = (path for path in files.called(Path(rest).name) if str(path).endswith(ending))
    return min(filter(files.is_file, paths), key=_depth, default=None)


def _depth(path: Path) -> tuple[int, str]:
    return len(path.parts), str(path)


def _names(workspace: Workspace) -> Iterable[str]:
    return [
        f"{package}/{Path(name).name}"
        for package in workspace.packages
        for name in workspace.files(package).names
        if name.endswith(_ENDINGS)
    ]

"""What is there to run the demo on: a ROS 1, a ROS 2, or neither."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from rtron.errors import SourceError

PYTHON_VARIABLE = "RTRON_ROS2_PYTHON"
"""The variable of the environment that names a Python with both rclpy and RTron."""
_ROS1_PROGRAMS = ("rosmaster", "roslaunch")
_CHECKOUT = Path(__file__).parents[4]
_IMPORT_TEST = "import rclpy, rtron"
_IMPORT_TEST_LIMIT = 60.0
_ROS1_HELP = "`make setup` in a checkout installs Debian's ROS 1 packages; or run it with --ros 2"
_ROS2_HELP = (
    'pip install "rtron[ros2]", source a ROS 2, or name a Python that has rclpy and rtron: '
    f"{PYTHON_VARIABLE}=…"
)


def find_ros_python(ros: int) -> Path:
    """Return the Python that runs RTron beside a ROS; SourceError if that ROS is not there."""
    return _ros1_python() if ros == 1 else _ros2_python()


def missing_requirements() -> dict[int, str]:
    """Return for each ROS what is lacking to run it; nothing if it can be run."""
    return {ros: _missing_requirement(ros) for ros in (1, 2)}


def _missing_requirement(ros: int) -> str:
    try:
        find_ros_python(ros)
    except SourceError as error:
        return str(error)
    return ""


def _ros1_python() -> Path:
    missing = [name for name in _ROS1_PROGRAMS if not shutil.which(name)]
    if missing:
        raise SourceError(f"there is no ROS 1: {', '.join(missing)} not found", help=_ROS1_HELP)
    return Path(sys.executable)


def _ros2_python() -> Path:
    if named := os.environ.get(PYTHON_VARIABLE):
        return _named_python(named)
    for python in _candidate_pythons():
        if _can_import(python):
            return Path(python)
    raise SourceError("there is no ROS 2: no Python that has rclpy", help=_ROS2_HELP)


def _named_python(name: str) -> Path:
    found = Path(shutil.which(name) or name).absolute()
    if not _can_import(str(found)):
        raise SourceError(f"{PYTHON_VARIABLE}={name}: cannot run {_IMPORT_TEST!r}", help=_ROS2_HELP)
    return found


def _candidate_pythons() -> Iterator[str]:
    if find_spec("rclpy"):
        yield sys.executable
    beside = _CHECKOUT / ".venv-ros2" / "bin" / "python"
    if beside.exists() and (_CHECKOUT / "pyproject.toml").exists():
        yield str(beside)


@cache
def _can_import(python: str) -> bool:
    """Tell whether a Python imports what the demo needs of it."""
    try:
        done = subprocess.run(  # noqa: S603 - our own words
            [python, "-c", _IMPORT_TEST],
            capture_output=True,
            cwd="/",  # modules in the user's folder are not to be imported
            timeout=_IMPORT_TEST_LIMIT,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0

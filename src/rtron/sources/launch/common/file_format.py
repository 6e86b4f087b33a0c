"""Which files `ros2 launch` opens (docs.ros.org: launch file formats)."""

from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded

MAX_BYTES = 2**20

_SUFFIXES = ("launch.xml", "launch.yaml", "launch.yml")
_PYTHON_SUFFIX = "launch.py"
_ENTRY_FUNCTION = b"generate_launch_description"


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

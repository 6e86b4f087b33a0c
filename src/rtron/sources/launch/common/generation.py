"""Which ROS a launch file is of (docs.ros.org: launch file formats; REP 149: build types)."""

from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import parse_launch, parse_xml
from rtron.sources.launch.ros1.file_search import is_ros2

_ROS2_SUFFIXES = frozenset({".py", ".yaml", ".yml"})


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
        pass
    return 2 if _is_in_ament_package(launch.absolute()) else 1


def _is_in_ament_package(path: Path) -> bool:
    manifest = next((m for f in path.parents if (m := f / "package.xml").is_file()), None)
    if manifest is None:
        return False
    try:
        root = parse_xml(manifest)
    except InputError:
        return False
    return any(str(tag.text).strip().startswith("ament_") for tag in root.iter("build_type"))

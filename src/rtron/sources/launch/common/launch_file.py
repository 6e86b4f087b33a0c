"""A launch file: which ROS it is of, and which arguments it has.

docs.ros.org: launch file formats; REP 149: build types.
"""

from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.packages import package_folder
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
    return any(str(tag.text).strip().startswith("ament_") for tag in root.iter("build_type"))

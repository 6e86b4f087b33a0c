"""The definitions of message types that are known: a plan's own, installed and standard ones."""

import os
from collections.abc import Collection, Iterable, Mapping
from functools import cache
from pathlib import Path

from rtron.errors import InputError, SourceError
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_parser import enter_type, parse_definition
from rtron.messages.ros2.installed_types import find_installed_type
from rtron.vocabulary import MessageDefinition, is_action_type, normalise_type


class DefinitionRegistry:
    """The message types that a plan defines, those of ROS 2 that are installed, and standard ones.

    What is installed counts before what is standard: that is what publishers here say.
    """

    def __init__(self, messages: Iterable[MessageDefinition] = (), *, ros: int = 1) -> None:
        self._plan_texts = {normalise_type(each.type): each.definition for each in messages}
        self.ros = ros
        self._found: dict[str, Definition | None] = {}
        self._open: list[str] = []

    def find(self, type: str) -> Definition | None:
        """Return the definition of `type`, the plan's before all others; None if unknown.

        InputError if the plan's is wrong, or the installed one cannot be used.
        """
        name = normalise_type(type)
        if name not in self._found:
            enter_type(name, self._open)
            try:
                self._found[name] = self._parse(name)
            finally:
                self._open.pop()
        return self._found[name]

    def defines(self, type: str) -> bool:
        """Tell whether the plan itself has a definition of `type`."""
        return normalise_type(type) in self._plan_texts

    def _parse(self, name: str) -> Definition | None:
        text = self._plan_texts.get(name)
        if text is not None:
            own = _goal(name, text) if is_action_type(name) else (name, text)
            return parse_definition(*own, lookup=self.find)
        installed = _installed(name) if self.ros != 1 else None
        return installed or self._standard(name)

    def _standard(self, name: str) -> Definition | None:
        text = _ACKERMANN.get(name)
        if text is not None:
            return parse_definition(name, text, lookup=self.find)
        standard = None if is_action_type(name) else standard_text(name, self.ros)
        return None if standard is None else parse_definition(name, standard)


def _installed(name: str) -> Definition | None:
    """Return the definition of an installed type, of an action its goal's; None if it is none."""
    installed = find_installed_type(name)
    if installed is None:
        return None
    try:
        return parse_definition(installed.definition_name, installed.definition())
    except (SourceError, InputError) as error:
        message = f"{installed.type} as it is installed here: {error}"
        raise InputError(message, help=error.help) from error


def _goal(action: str, text: str) -> tuple[str, str]:
    """Return the goal of an action of ROS 2: its name, and what stands before the first `---`."""
    package, _, name = action.split("/")
    lines = text.splitlines()
    goal = lines[: lines.index("---")] if "---" in lines else lines
    others = (n for n, line in enumerate(lines) if n > len(goal) and line.startswith("====="))
    rest = lines[next(others, len(lines)) :]
    return f"{package}/{name}_Goal", "\n".join((*goal, *rest))


def standard_text(name: str, ros: int) -> str | None:
    """Return the definition of a standard type, with those that it names; None if it is none.

    It is that of the distribution that was sourced; else of Noetic, or of Jazzy.
    """
    if name == "geometry_msgs/Twist":
        return TWIST
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - most guards need none
    from rosbags.typesys.base import TypesysError  # noqa: PLC0415

    usual = Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_JAZZY
    sourced = Stores.__members__.get(f"ROS{ros}_{os.environ.get('ROS_DISTRO', '').upper()}")
    store = get_typestore(sourced or usual)
    package, _, last = name.partition("/")
    try:
        return str(store.generate_msgdef(f"{package}/msg/{last}", ros_version=ros)[0])
    except TypesysError:
        return None


_COMPONENTS = "float64 x\nfloat64 y\nfloat64 z\n"
_VECTOR = f"{'=' * 80}\nMSG: geometry_msgs/Vector3\n{_COMPONENTS}"
TWIST = f"geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n{_VECTOR}"
"""What most guards stop, the same in all distributions: it takes no table of all their types."""


def standard_names(package: str) -> frozenset[str]:
    """Return the names of the messages that Noetic's or Jazzy's standard package of a name has."""
    return frozenset(_standard().get(package, ()))


@cache
def _standard() -> Mapping[str, Collection[str]]:
    """Read the names from a file: rosbags makes a class of each, in each process of a scan."""
    lines = Path(__file__).with_name("standard_messages.txt").read_text("utf-8").splitlines()
    return {package: names.split() for package, _, names in (line.partition(":") for line in lines)}


_DRIVE = "\n".join(
    f"float32 {name}"
    for name in ("steering_angle", "steering_angle_velocity", "speed", "acceleration", "jerk")
)
_ACKERMANN = {
    "ackermann_msgs/AckermannDrive": _DRIVE,
    "ackermann_msgs/AckermannDriveStamped": "Header header\nAckermannDrive drive",
}

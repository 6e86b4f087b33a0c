"""The joints of a robot description, whose transforms robot_state_publisher broadcasts."""

from functools import lru_cache

from rtron.errors import InputError
from rtron.sources.models.common.values import Placeholder, Value
from rtron.sources.xacro import XmlElement, parse_element

_MOVING = frozenset({"revolute", "continuous", "prismatic"})


def joints(description: Value, *, fixed: bool) -> list[dict[str, str]]:
    """Return the `parent` and `child` links of the joints in the text of a description.

    They are those that are fixed, or those that have a position.
    """
    types = frozenset({"fixed"}) if fixed else _MOVING
    is_known = isinstance(description, str) and not isinstance(description, Placeholder)
    found = _read_joints(description) if is_known else ()
    return [{"parent": above, "child": below} for type, above, below in found if type in types]


@lru_cache(maxsize=4)
def _read_joints(description: str) -> tuple[tuple[str, str, str], ...]:
    """Return type, parent and child of each joint; nothing of what cannot be read."""
    try:
        root = parse_element(description, "robot_description")
    except InputError:
        return ()
    return tuple(
        (joint.attributes.get("type", ""), _link(joint, "parent"), _link(joint, "child"))
        for joint in root.elements("joint")
    )


def _link(joint: XmlElement, end: str) -> str:
    found = joint.find(end)
    return found.attributes.get("link", "") if found is not None else ""

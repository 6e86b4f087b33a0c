"""Which elements are xacro's own statements, with the prefix or as Kinetic spelled them without."""

from collections.abc import Mapping

from rtron.sources.xacro.xml_element import XmlElement

PREFIX = "xacro:"

_WITHOUT_PREFIX: Mapping[str, frozenset[str]] = {
    "arg": frozenset({"name", "default"}),
    "if": frozenset({"value"}),
    "include": frozenset({"filename"}),
    "insert_block": frozenset({"name"}),
    "macro": frozenset({"name"}),
    "property": frozenset({"name"}),
    "unless": frozenset({"value"}),
}

_STATEMENTS = _WITHOUT_PREFIX.keys() | {"attribute", "call", "element"}


def statement_name(element: XmlElement) -> str:
    """Return which of xacro's statements an element is, "" if none; macro calls are none."""
    name = element.tag.removeprefix(PREFIX)
    if name != element.tag:
        return name if name in _STATEMENTS else ""
    needed = _WITHOUT_PREFIX.get(name)
    if needed is None or not needed <= element.attributes.keys():
        return ""
    return "" if name == "include" and any(element.elements()) else name

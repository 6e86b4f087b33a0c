"""A file of SDF as Gazebo reads it: comments may stand before its XML declaration (tinyxml)."""

import re
from pathlib import Path

from rtron.sources.bounded_file import read_regular_file
from rtron.sources.launch.common.xml_document import MAX_BYTES
from rtron.sources.xacro import XmlElement, parse_element, read_element

_BEFORE = re.compile(r"\s+|<!--.*?-->", re.DOTALL)


def read_sdf(path: Path) -> XmlElement:
    """Return a file's root element; raise InputError as `read_element` does."""
    text, at = read_regular_file(path, MAX_BYTES).decode(errors="replace"), 0
    while found := _BEFORE.match(text, at):
        at = found.end()
    if not at or not text.startswith("<?xml", at):
        return read_element(path)
    return parse_element(text[:at] + text[at:].partition("?>")[2], str(path))

"""A launch file's XML: safely parsed, its elements counted in document order."""

import os.path
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from lxml import etree

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_bounded

MAX_BYTES = 1024 * 1024

_VERSION = re.compile(rb"""\A(\xef\xbb\xbf)?<\?xml\s+version\s*=\s*(["'])1\.0[\w.:-]+\2""")
Element: TypeAlias = etree._Element  # noqa: SLF001 - lxml gives the class no public name


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchDocument:
    """A launch file's `<launch>` element, and each element's place in document order from 0.

    `path` is absolute and spelled as roslaunch opens it.
    """

    path: str
    launch: Element
    element_numbers: Mapping[Element, int]

    @property
    def folder(self) -> str:
        """What `$(dirname)` means in the file: its folder, `..` taken out without a look at it."""
        return os.path.abspath(os.path.dirname(self.path))  # noqa: PTH100, PTH120 - no links followed


def parse_launch(path: str) -> LaunchDocument:
    """Parse a launch file; raise InputError where it is not XML with one `<launch>`."""
    root = parse_xml(Path(path))
    launches = list(root.iter("launch"))
    if len(launches) != 1:
        message = f"has {len(launches)} <launch> elements, not one"
        raise InputError(message, path=path, help="is this a launch file of ROS 1?")
    numbers = {element: number for number, element in enumerate(root.iter("*"))}
    return LaunchDocument(path=path, launch=launches[0], element_numbers=numbers)


def parse_xml(path: Path) -> Element:
    """Return a file's root element; raise InputError if it is no XML, too large, or has a DTD."""
    if path_exists(path) and not path.is_file():
        raise InputError("is no file", path=str(path), help="devices and pipes are not read")
    return parse_xml_bytes(read_bounded(path, MAX_BYTES), str(path))


def parse_xml_bytes(data: bytes, path: str) -> Element:
    """Return the root element of what was read from `path`; raise InputError as `parse_xml`.

    A version like `1.0.0` counts as 1.0, as it does for the tools of ROS.
    """
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=False)
    try:
        root = etree.fromstring(_VERSION.sub(rb'\1<?xml version="1.0"', data), parser)
    except etree.XMLSyntaxError as error:
        raise InputError(f"not XML: {error.msg}", path=path, line=error.lineno or 0) from None
    if etree.ElementTree(root).docinfo.internalDTD is not None:
        help = "take the <!DOCTYPE …> out; entities are not read"
        raise InputError("has a document type", path=path, line=1, help=help)
    return root


def line_of(element: Element) -> int:
    """Return an element's line, from 1; 0 if it is not known."""
    line = element.sourceline
    return line if isinstance(line, int) else 0

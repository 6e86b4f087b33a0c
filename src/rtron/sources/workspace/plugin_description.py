"""Plugin descriptions: which class of which library is loaded by which name (ROS wiki: pluginlib).

Nodelets are plugins of base class `nodelet::Nodelet`.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.launch.common.xml_document import MAX_BYTES, Element, parse_xml
from rtron.sources.workspace.program import Program

_DECLARATION = re.compile(rb"\A\s*<\?xml[^>]*\?>")


@dataclass(frozen=True, slots=True, kw_only=True)
class PluginClass:
    """A class as its description in `package` has it, exported under `tag`.

    `library` is spelled as there; `name` is the type where the description gives none.
    """

    name: str
    type: str
    base: str
    library: str
    package: str
    tag: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Plugin:
    """A plugin's class, and the library that holds it: None if the library is not built here."""

    plugin_class: PluginClass
    program: Program | None = None


def read_plugin_description(path: Path, package: str, tag: str) -> Iterator[PluginClass]:
    """Yield the classes of a plugin description; raise InputError where it cannot be read."""
    for library in _root(path).iter("library"):
        for element in library.iterchildren("class"):
            type_ = element.get("type", "").strip()
            yield PluginClass(
                name=element.get("name", "").strip() or type_,
                type=type_,
                base=element.get("base_class_type", "").strip(),
                library=library.get("path", ""),
                package=package,
                tag=tag,
            )


def library_name(spelled: str) -> str:
    """Return a library's plain name: `lib/libx`, `libx.so` and `x` are all `x`."""
    name = spelled.strip().rpartition("/")[2]
    return name.partition(".so")[0].removeprefix("lib")


def _root(path: Path) -> Element:
    """Return a description's root; pluginlib also reads several libraries without one."""
    try:
        return parse_xml(path)
    except InputError:
        text = _DECLARATION.sub(b"", read_regular_file(path, MAX_BYTES))
        parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=False)
        try:
            return etree.fromstring(b"<class_libraries>%b</class_libraries>" % text, parser)
        except etree.XMLSyntaxError as error:
            why = f"not XML: {error.msg}"
            raise InputError(why, path=str(path), line=error.lineno or 0) from None

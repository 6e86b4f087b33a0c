"""An XML element of a robot description, with the file and line that it was written at."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeAlias
from xml.sax.saxutils import escape, quoteattr

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import (
    MAX_BYTES,
    Element,
    line_of,
    parse_xml,
    parse_xml_bytes,
)
from rtron.vocabulary import Evidence

XMLNS = "xmlns:"

_DECLARATION = re.compile(rb"^\s*<\?xml[^>]*\?>")


@dataclass(frozen=True, slots=True, kw_only=True)
class XmlElement:
    """One element: its name as written with its prefix, and its texts and elements in order."""

    tag: str
    evidence: Evidence
    attributes: Mapping[str, str] = field(default_factory=dict)
    children: "tuple[XmlNode, ...]" = ()

    @property
    def text(self) -> str:
        """What stands directly in the element, stripped."""
        return "".join(child for child in self.children if isinstance(child, str)).strip()

    def elements(self, tag: str = "") -> "Iterator[XmlElement]":
        """Yield the elements directly within, all or those named `tag`."""
        for child in self.children:
            if isinstance(child, XmlElement) and tag in {"", child.tag}:
                yield child

    def find(self, tag: str) -> "XmlElement | None":
        """Return the first element named `tag` directly within."""
        return next(self.elements(tag), None)

    def walk(self) -> "Iterator[XmlElement]":
        """Yield this element and all below, in document order."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(list(element.elements())))


XmlNode: TypeAlias = XmlElement | str


def read_element(path: Path) -> XmlElement:
    """Return a file's root element, with the namespaces in it declared there.

    Raise InputError if it is no XML, too large, nested too deep, or has a document type.
    """
    return _with_namespaces(parse_xml(path), str(path))


def parse_element(text: str, path: str) -> XmlElement:
    """Return the root element of a text that was read from `path`; raise as `read_element`."""
    data = text.encode(errors="replace")
    if len(data) > MAX_BYTES:
        raise InputError("a description is too large", path=path)
    return _with_namespaces(parse_xml_bytes(_DECLARATION.sub(b"", data), path), path)


_SHAPES = frozenset({"visual", "collision", "inertial", "material"})


def without_shapes(root: XmlElement) -> XmlElement:
    """Return a description without what its links look like and weigh, and without its blanks."""
    children = (
        child if isinstance(child, str) else without_shapes(child)
        for child in root.children
        if not (child.isspace() if isinstance(child, str) else child.tag in _SHAPES)
    )
    return replace(root, children=tuple(children))


def shorten_description(text: str, path: str) -> str:
    """Return a large description's text without shapes; raise InputError where it is none."""
    data = _DECLARATION.sub(b"", text.encode(errors="replace"))
    root = _with_namespaces(parse_xml_bytes(data, path), path)
    if root.tag != "robot":
        raise InputError(f"begins with <{root.tag}>, not with <robot>", path=path)
    return xml_text(without_shapes(root))


def _with_namespaces(source: Element, path: str) -> XmlElement:
    try:
        root = _convert(source, path)
    except RecursionError:
        raise InputError("is nested too deep", path=path) from None
    return XmlElement(
        tag=root.tag,
        evidence=root.evidence,
        attributes={**_namespaces(source), **root.attributes},
        children=root.children,
    )


def xml_text(root: XmlElement) -> str:
    """Return an element as XML text."""
    pieces: list[str] = []
    _write(root, pieces)
    return "".join(pieces)


def _convert(source: Element, path: str) -> XmlElement:
    children: list[XmlNode] = [source.text or ""]
    for child in source:
        if isinstance(child.tag, str):
            children.append(_convert(child, path))
        children.append(child.tail or "")
    return XmlElement(
        tag=_prefixed_name(str(source.tag), source.prefix),
        evidence=Evidence(file=path, line=line_of(source)),
        attributes={_attribute(source, str(k)): str(v) for k, v in source.attrib.items()},
        children=tuple(child for child in children if child != ""),
    )


def _attribute(source: Element, name: str) -> str:
    uri = name[1:].partition("}")[0] if name.startswith("{") else None
    prefixes = (prefix for prefix, known in source.nsmap.items() if known == uri and prefix)
    return _prefixed_name(name, next(prefixes, "xml") if uri else None)


def _prefixed_name(name: str, prefix: str | None) -> str:
    local = name.rpartition("}")[2]
    return f"{prefix}:{local}" if prefix else local


def _namespaces(source: Element) -> dict[str, str]:
    declared = (element.nsmap for element in source.iter("*") if element.prefix or element.nsmap)
    return {f"{XMLNS}{p}": str(uri) for nsmap in declared for p, uri in nsmap.items() if p}


def _write(element: XmlElement, pieces: list[str]) -> None:
    attributes = "".join(f" {name}={quoteattr(v)}" for name, v in element.attributes.items())
    pieces.append(f"<{element.tag}{attributes}>")
    for child in element.children:
        if isinstance(child, str):
            pieces.append(escape(child))
        else:
            _write(child, pieces)
    pieces.append(f"</{element.tag}>")


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

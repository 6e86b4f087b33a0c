"""A launch file of ROS 2 as elements, whether it was written in XML, YAML or Python."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import line_of, parse_xml
from rtron.sources.launch.ros2.context_view import View
from rtron.sources.launch.ros2.substitutions.template import Written
from rtron.sources.launch.ros2.xml_yaml.yaml_document import YamlBody, yaml_body

_YAML = (".yaml", ".yml")


@dataclass(frozen=True, slots=True)
class Element:
    """An action of a launch file, or what belongs to one.

    `place` counts the elements of an XML text in document order, the root being 0; in YAML it is
    where the element's value begins in the text, in characters. `file` is empty where it is that of
    the launch itself. `run` calls a function of a Python launch file, for the actions it returns.
    """

    tag: str
    attributes: Mapping[str, Written]
    children: tuple["Element", ...] = ()
    place: int = 0
    line: int = 0
    file: str = ""
    run: Callable[[View], tuple["Element", ...]] | None = None

    def named(self, tag: str) -> Iterator["Element"]:
        """Yield the children of one kind."""
        return (child for child in self.children if child.tag == tag)

    def placed(self, line: int, file: str) -> "Element":
        """Return it, and what is in it, at a line of a file where they have no place yet."""
        children = tuple(child.placed(line, file) for child in self.children)
        return replace(self, children=children, line=self.line or line, file=self.file or file)

    def plain(self, key: str) -> str:
        """Return an attribute as it is written; empty where it is not plain text."""
        written = self.attributes.get(key, "")
        if isinstance(written, str):
            return written
        return "".join(piece for piece in written if isinstance(piece, str))


def parse_elements(path: str) -> Element:
    """Return a launch file's `launch` element; raise InputError where it has none or is unsafe."""
    root = _yaml(path) if path.endswith(_YAML) else _xml(path)
    if root.tag != "launch":
        raise InputError(f"begins with <{root.tag}>, not with <launch>", path=path)
    return root


def _xml(path: str) -> Element:
    root = parse_xml(Path(path))
    made: dict[object, Element] = {}
    listed = list(root.iter("*"))
    for place, element in reversed(list(enumerate(listed))):
        made[element] = Element(
            tag=str(element.tag),
            attributes={str(name): str(value) for name, value in element.attrib.items()},
            children=tuple(made[child] for child in element if child in made),
            place=place,
            line=line_of(element),
        )
    return made[root]


def _yaml(path: str) -> Element:
    return _of_body(yaml_body(path))


def _of_body(body: YamlBody) -> Element:
    return Element(
        tag=body.tag,
        attributes=body.attributes,
        children=tuple(map(_of_body, body.children)),
        place=body.place,
        line=body.line,
    )

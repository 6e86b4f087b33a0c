"""Launch files of ROS 2 in XML and YAML, parsed (docs.ros.org: launch file formats).

ROS 1's syntax in one, which launch refuses, is noted and read as it is meant (docs.ros.org:
"Migrating launch files from ROS 1 to ROS 2").
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import yaml

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.xml_document import line_of, parse_xml
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.substitutions.template import TemplateText
from rtron.vocabulary import Evidence, UnresolvedItem
from rtron.yaml_safety import YamlRules, check_yaml, yaml_errors


@dataclass(frozen=True, slots=True)
class Element:
    """An action of a launch file, or what belongs to one.

    `position` counts the elements of an XML text in document order, the root being 0; in YAML it is
    where the element's value begins in the text, in characters. `file` is empty where it is that of
    the launch itself. `expand` calls a function of a Python launch file, for the actions it
    returns.
    """

    tag: str
    attributes: Mapping[str, TemplateText]
    children: tuple["Element", ...] = ()
    position: int = 0
    line: int = 0
    file: str = ""
    expand: Callable[[ContextView], tuple["Element", ...]] | None = None

    def children_named(self, tag: str) -> Iterator["Element"]:
        """Yield the children of one kind."""
        return (child for child in self.children if child.tag == tag)

    def with_location(self, line: int, file: str) -> "Element":
        """Return it, and what is in it, at a line of a file where they have no place yet."""
        children = tuple(child.with_location(line, file) for child in self.children)
        return replace(self, children=children, line=self.line or line, file=self.file or file)

    def plain_text(self, key: str) -> str:
        """Return an attribute as it is written; empty where it is not plain text."""
        text = self.attributes.get(key, "")
        if isinstance(text, str):
            return text
        return "".join(part for part in text if isinstance(part, str))


MAX_BYTES = 256 * 1024
_YAML_RULES = YamlRules(
    max_depth=60, help="write out what aliases stand for: no two nodes can share their text"
)
_YAML = (".yaml", ".yml")
_ALIASES = {"bool_arg": "arg", "composable_lifecycle_node": "composable_node"}
"""Elements, since Lyrical, that are read as others are: by which choices or states they differ."""


def parse_elements(path: str) -> Element:
    """Return a launch file's `launch` element; raise InputError where it has none or is unsafe."""
    root = _read_yaml(path) if path.endswith(_YAML) else _read_xml(path)
    if root.tag != "launch":
        raise InputError(f"begins with <{root.tag}>, not with <launch>", path=path)
    return root


def _read_xml(path: str) -> Element:
    root = parse_xml(Path(path))
    elements: dict[object, Element] = {}
    document_order = list(root.iter("*"))
    for position, element in reversed(list(enumerate(document_order))):
        elements[element] = Element(
            tag=_ALIASES.get(str(element.tag), str(element.tag)),
            attributes={str(name): str(value) for name, value in element.attrib.items()},
            children=tuple(elements[child] for child in element if child in elements),
            position=position,
            line=line_of(element),
        )
    return elements[root]


def _read_yaml(path: str) -> Element:
    """Return a file's one root; raise InputError if it is not YAML, too large, or has aliases."""
    if path_exists(Path(path)) and not Path(path).is_file():
        raise InputError("is no file", path=path, help="devices and pipes are not read")
    try:
        text = read_bounded(Path(path), MAX_BYTES).decode()
    except UnicodeDecodeError:
        raise InputError("not UTF-8 text", path=path) from None
    with yaml_errors(path):
        check_yaml(text, path, _YAML_RULES, loader=yaml.SafeLoader)
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    if not isinstance(root, yaml.MappingNode) or len(root.value) != 1:
        raise InputError("has not one root, `launch:`", path=path, line=1)
    return next(_elements_of_list([root], path))


def _elements_of_list(items: list[yaml.Node], path: str) -> Iterator[Element]:
    """Yield the actions of a list, each a mapping of one key."""
    for item in items:
        if not isinstance(item, yaml.MappingNode) or len(item.value) != 1:
            line = item.start_mark.line + 1
            raise InputError("an action is a mapping of one key", path=path, line=line)
        key, value = item.value[0]
        yield _element_of_entry(str(key.value), value, path)


def _element_of_entry(tag: str, value: yaml.Node, path: str) -> Element:
    entries = value.value if isinstance(value, yaml.MappingNode) else []
    keys = [str(key.value) for key, _ in entries]
    if len(set(keys)) < len(keys) or "<<" in keys:
        line = value.start_mark.line + 1
        raise InputError("says a key twice, or merges others in", path=path, line=line)
    children: list[Element] = []
    if isinstance(value, yaml.SequenceNode):
        children += _elements_of_list(value.value, path)
    for key, inner in entries:
        if isinstance(inner, yaml.SequenceNode) and key.value == "children":
            children += _elements_of_list(inner.value, path)
        elif isinstance(inner, yaml.SequenceNode):
            children += (
                _element_of_entry(str(key.value), part, path)
                for part in inner.value
                if isinstance(part, yaml.MappingNode)
            )
    return Element(
        tag=_ALIASES.get(tag, tag),
        attributes={
            str(key.value): text for key, inner in entries if (text := _text(inner)) is not None
        },
        children=tuple(children),
        position=value.start_mark.index,
        line=value.start_mark.line + 1,
    )


def _text(node: yaml.Node) -> str | None:
    """Return a plain value as it is written, a list of them as YAML; None for any other."""
    if isinstance(node, yaml.ScalarNode):
        return str(node.value)
    if not isinstance(node, yaml.SequenceNode) or not node.value:
        return None
    if not all(isinstance(item, yaml.ScalarNode) for item in node.value):
        return None
    items = [f"{item.style or ''}{item.value}{item.style or ''}" for item in node.value]
    return f"[{', '.join(items)}]"


_ATTRIBUTES: Mapping[str, Mapping[str, str]] = {
    "node": {"type": "exec", "ns": "namespace", "required": "", "clear_params": ""},
    "group": {"ns": "", "clear_params": ""},
    "include": {"ns": "", "clear_params": "", "pass_all_args": ""},
}
"""Attributes that ROS 1 alone has, and how ROS 2 spells them."""
_TAGS = frozenset({"rosparam", "machine", "test"})
_OF_NODES = frozenset({"param", "remap"})
_AROUND_NODES = frozenset({"launch", "group"})


def read_ros1_syntax(element: Element, path: str) -> tuple[Element, list[UnresolvedItem]]:
    """Return an element as ROS 2 would write it, and a note on each word of ROS 1 in it."""
    notes = [_note(element, f"its {name}", path) for name in _attributes(element)]
    children = []
    for child in element.children:
        if child.tag in _TAGS or (child.tag in _OF_NODES and element.tag in _AROUND_NODES):
            notes.append(_note(child, f"it, in <{element.tag}>,", path))
            continue
        translated, of_child = read_ros1_syntax(child, path)
        children.append(translated)
        notes += of_child
    spelled = _ATTRIBUTES.get(element.tag, {})
    renamed = {spelled.get(name) or name: text for name, text in element.attributes.items()}
    return replace(element, attributes=renamed, children=tuple(children)), notes


def _attributes(element: Element) -> Iterator[str]:
    spelled = _ATTRIBUTES.get(element.tag, {})
    return (name for name in element.attributes if name in spelled)


def _note(element: Element, subject: str, path: str) -> UnresolvedItem:
    named = next(filter(None, map(element.plain_text, ("file", "name", "from"))), "")
    return UnresolvedItem(
        what=f"{element.tag} {named[:80]}".strip(),
        why=f"{subject} is syntax of ROS 1, which the launch of ROS 2 refuses",
        evidence=(Evidence(file=path, line=element.line),),
    )

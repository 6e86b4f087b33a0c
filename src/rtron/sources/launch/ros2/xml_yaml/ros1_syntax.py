"""ROS 1's launch syntax in an XML launch file of ROS 2: launch refuses it, and a note says so.

Sources: docs.ros.org, "Migrating launch files from ROS 1 to ROS 2"; ROS wiki, roslaunch/XML.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence, UnresolvedItem

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

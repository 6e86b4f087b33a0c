"""Evaluates a description element by element; nothing of it is executed (ROS wiki: xacro).

Elements are read only: each evaluation makes new ones, which keep the place they were written at.
Kinetic's spellings without the `xacro:` prefix count too, as Kinetic and Melodic read them.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar, TypeAlias

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.budget import MAX_DEPTH
from rtron.sources.xacro.evaluation_context import Surroundings
from rtron.sources.xacro.files import included_files
from rtron.sources.xacro.frame import Frame
from rtron.sources.xacro.macro import Macro, read_macro
from rtron.sources.xacro.macros import bind_blocks, bind_parameters, find_macro
from rtron.sources.xacro.properties import define_property
from rtron.sources.xacro.scopes import truth
from rtron.sources.xacro.statements import PREFIX, statement
from rtron.sources.xacro.xml_element import XMLNS, XmlElement, XmlNode, read_element

Handler: TypeAlias = Callable[["Evaluator", XmlElement, Frame], list[XmlNode]]

_XML_NAME = re.compile(r"[A-Za-z_][\w.:-]*")


@dataclass(slots=True, kw_only=True)
class Evaluator:
    """Turns elements into what they stand for; what cannot be evaluated is noted and left out."""

    around: Surroundings
    expanding: list[Macro] = field(default_factory=list)

    def node(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        """Return what an element stands for."""
        if self.around.budget.exhausted:
            return []
        self.around.budget.element()
        if self.around.budget.exhausted:
            self.around.note(element, f"<{element.tag}>", self.around.budget.exhausted)
        name = statement(element)
        if name:
            return self.handlers[name](self, element, frame)
        if element.tag.startswith(PREFIX) or self._is_call(element, frame):
            return self._call(element, frame)
        return [self.plain(element, frame)]

    def plain(self, element: XmlElement, frame: Frame) -> XmlElement:
        """Return an element that stands for itself, its attributes and contents evaluated."""
        attributes = {
            name: str(self.text(value, element, frame, name))
            for name, value in element.attributes.items()
            if not name.startswith((PREFIX, XMLNS))
        }
        children = self.children(element, frame.owned_by(attributes))
        return replace(element, attributes=attributes, children=tuple(children))

    def children(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        """Return what the contents of an element stand for."""
        nodes: list[XmlNode] = []
        for child in element.children:
            if isinstance(child, XmlElement):
                nodes.extend(self.node(child, frame))
            else:
                nodes.append(str(self.text(child, element, frame, "text")))
        return nodes

    def text(self, text: str, element: XmlElement, frame: Frame, where: str = "") -> Value:
        """Return a text's value; where it has none, the text as it is written, and note it."""
        with self.around.noting(element, f"<{element.tag}> {where}: {text.strip()[:200]}"):
            value = self.around.value(text, frame.symbols)
            self.around.budget.text(len(text) if value is text else len(str(value)))
            return value
        return text

    def included(self, element: XmlElement, frame: Frame) -> list[XmlElement]:
        """Return the roots of the files that an include names; note what is not there."""
        paths, what = [], f"include {element.attributes.get('filename', '')}"
        roots: list[XmlElement] = []
        with self.around.noting(element, what):
            name = str(self.around.value(required(element, "filename"), frame.symbols))
            optional = truth(element.attributes.get("optional", "false"))
            found = included_files(name, self.around.files[-1])
            paths = [str(path) for path in found if not optional or is_there(path)]
        for path in paths:
            with self.around.noting(element, what):
                roots.append(self._root(path))
        return roots

    def _root(self, path: str) -> XmlElement:
        if path in self.around.files:
            raise InputError("includes itself", path=path)
        if len(self.around.files) > MAX_DEPTH:
            raise InputError(f"is included more than {MAX_DEPTH} deep", path=path)
        self.around.budget.file()
        root = read_element(Path(path))
        self.around.declare(root)
        return root

    def _include(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        namespace = element.attributes.get("ns")
        if namespace:
            frame = frame.named(str(self.text(namespace, element, frame, "ns")))
        nodes: list[XmlNode] = []
        for root in self.included(element, frame):
            with self.around.reading(root.evidence.file):
                nodes.extend(self.children(root, frame.owned_by({})))
        return nodes

    def _is_call(self, element: XmlElement, frame: Frame) -> bool:
        """Tell whether an element without the prefix calls a macro.

        A macro's body may hold an element of the macro's own name, which does not.
        """
        found = find_macro(element.tag, frame)
        if found is None or any(found[0] is macro for macro in self.expanding):
            return False
        return element.attributes.keys() <= set(found[0].parameters)

    def _call(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        found = find_macro(element.tag.removeprefix(PREFIX), frame)
        with self.around.noting(element):
            if found is None:
                raise ValueError("there is no macro of this name")
            if len(self.expanding) == MAX_DEPTH:
                raise ValueError(f"macros call each other more than {MAX_DEPTH} deep")
            return self._expanded(element, frame, *found)
        return []

    def _expanded(
        self, element: XmlElement, frame: Frame, macro: Macro, outer: Frame
    ) -> list[XmlNode]:
        inner = outer.inner()
        bind_parameters(self.around, element, macro, frame, inner)
        blocks = self.children(element, frame.owned_by({}))
        bind_blocks(self.around, element, macro, blocks, inner)
        self.expanding.append(macro)
        try:
            return self.children(macro.body, inner)
        finally:
            self.expanding.pop()

    def _dynamic_call(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        attributes = dict(element.attributes)
        name = self.text(attributes.pop("macro", ""), element, frame, "macro")
        return self._call(replace(element, tag=f"{PREFIX}{name}", attributes=attributes), frame)

    def _element(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        attributes = dict(element.attributes)
        name = str(self.text(attributes.pop(f"{PREFIX}name", ""), element, frame, "name"))
        if not _XML_NAME.fullmatch(name) or name == f"{PREFIX}element":
            self.around.note(element, f"<{element.tag}>", f"'{name}' is no element's name")
            return []
        return self.node(replace(element, tag=name, attributes=attributes), frame)

    def _attribute(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        name, value = (
            str(self.text(element.attributes.get(key, ""), element, frame, key))
            for key in ("name", "value")
        )
        if _XML_NAME.fullmatch(name):
            frame.owner[name] = value
        else:
            self.around.note(element, f"<{element.tag}>", f"'{name}' is no attribute's name")
        return []

    def _condition(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        text = element.attributes.get("value", "")
        with self.around.noting(element, f"<{element.tag}> value: {text[:200]}"):
            holds = truth(self.around.value(text, frame.symbols))
            unless = element.tag.removeprefix(PREFIX) == "unless"
            return [] if holds is unless else self.children(element, frame.owned_by({}))
        return []

    def _insert_block(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        name = element.attributes.get("name", "")
        with self.around.noting(element, f"block {name}"):
            if f"**{name}" in frame.symbols:
                block = frame.symbols.get(f"**{name}", self.around.value)
                return self.children(block, frame.owned_by({}))
            if f"*{name}" in frame.symbols:
                return [self.plain(frame.symbols.get(f"*{name}", self.around.value), frame)]
            raise ValueError("is not defined")
        return []

    def _argument(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        name, default = element.attributes.get("name", ""), element.attributes.get("default")
        if name not in self.around.arguments and default is not None:
            with self.around.noting(element, f"argument {name}"):
                value = str(self.around.value(default, frame.symbols))
                self.around.arguments[name] = value
        return []

    def _macro(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        name = element.attributes.get("name", "").removeprefix(PREFIX)
        frame.macros.set(name, read_macro(element), lazy=False)
        return []

    def _property(self, element: XmlElement, frame: Frame) -> list[XmlNode]:
        with self.around.noting(element, f"property {element.attributes.get('name', '')}"):
            define_property(self.around, element, frame.symbols)
        return []

    handlers: ClassVar[Mapping[str, Handler]] = {
        "arg": _argument,
        "attribute": _attribute,
        "call": _dynamic_call,
        "element": _element,
        "if": _condition,
        "include": _include,
        "insert_block": _insert_block,
        "macro": _macro,
        "property": _property,
        "unless": _condition,
    }


def required(element: XmlElement, attribute: str) -> str:
    """Return an attribute; raise ValueError where it is not written."""
    if attribute not in element.attributes:
        raise ValueError(f"has no '{attribute}'")
    return element.attributes[attribute]

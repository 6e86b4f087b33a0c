"""Evaluates a description element by element; nothing of it is executed (ROS wiki: xacro).

Elements are read only: each evaluation makes new ones, with their locations.
Kinetic's spellings without the `xacro:` prefix count too, as Kinetic and Melodic read them.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar, TypeAlias

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.budget import MAX_DEPTH
from rtron.sources.xacro.evaluation_context import EvaluationContext, included_files
from rtron.sources.xacro.macros import (
    XacroMacro,
    bind_blocks,
    bind_parameters,
    find_macro,
    read_macro,
)
from rtron.sources.xacro.scopes import ElementScope, define_property, truth_value
from rtron.sources.xacro.xml_element import (
    PREFIX,
    XMLNS,
    XmlElement,
    XmlNode,
    read_element,
    statement_name,
)

StatementHandler: TypeAlias = Callable[["XacroEvaluator", XmlElement, ElementScope], list[XmlNode]]

_XML_NAME = re.compile(r"[A-Za-z_][\w.:-]*")


@dataclass(slots=True, kw_only=True)
class XacroEvaluator:
    """Turns elements into what they stand for; what cannot be evaluated is noted and left out."""

    context: EvaluationContext
    active_macros: list[XacroMacro] = field(default_factory=list)

    def evaluate_node(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        """Return what an element stands for."""
        if self.context.budget.exceeded_bound:
            return []
        self.context.budget.count_element()
        if self.context.budget.exceeded_bound:
            self.context.add_unresolved(
                element, f"<{element.tag}>", self.context.budget.exceeded_bound
            )
        name = statement_name(element)
        if name:
            return self.handlers[name](self, element, frame)
        if element.tag.startswith(PREFIX) or self._is_call(element, frame):
            return self._call_macro(element, frame)
        return [self.evaluate_element(element, frame)]

    def evaluate_element(self, element: XmlElement, frame: ElementScope) -> XmlElement:
        """Return an element that stands for itself, its attributes and contents evaluated."""
        attributes = {
            name: str(self.evaluate_text(value, element, frame, name))
            for name, value in element.attributes.items()
            if not name.startswith((PREFIX, XMLNS))
        }
        children = self.evaluate_children(element, frame.with_parent_attributes(attributes))
        return replace(element, attributes=attributes, children=tuple(children))

    def evaluate_children(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        """Return what the contents of an element stand for."""
        nodes: list[XmlNode] = []
        for child in element.children:
            if isinstance(child, XmlElement):
                nodes.extend(self.evaluate_node(child, frame))
            else:
                nodes.append(str(self.evaluate_text(child, element, frame, "text")))
        return nodes

    def evaluate_text(
        self, text: str, element: XmlElement, frame: ElementScope, where: str = ""
    ) -> Value:
        """Return a text's value; where it has none, the text as it is written, and note it."""
        with self.context.noting_errors(element, f"<{element.tag}> {where}: {text.strip()[:200]}"):
            value = self.context.evaluate_text(text, frame.symbols)
            self.context.budget.count_text(len(text) if value is text else len(str(value)))
            return value
        return text

    def included_roots(self, element: XmlElement, frame: ElementScope) -> list[XmlElement]:
        """Return the roots of the files that an include names; note what is not there."""
        paths, what = [], f"include {element.attributes.get('filename', '')}"
        roots: list[XmlElement] = []
        with self.context.noting_errors(element, what):
            name = str(
                self.context.evaluate_text(required_attribute(element, "filename"), frame.symbols)
            )
            optional = truth_value(element.attributes.get("optional", "false"))
            found = included_files(name, self.context.open_files[-1])
            paths = [str(path) for path in found if not optional or path_exists(path)]
        for path in paths:
            with self.context.noting_errors(element, what):
                roots.append(self._read_included(path))
        return roots

    def _read_included(self, path: str) -> XmlElement:
        if path in self.context.open_files:
            raise InputError("includes itself", path=path)
        if len(self.context.open_files) > MAX_DEPTH:
            raise InputError(f"is included more than {MAX_DEPTH} deep", path=path)
        self.context.budget.count_file()
        root = read_element(Path(path))
        self.context.add_namespaces(root)
        return root

    def _include(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        namespace = element.attributes.get("ns")
        if namespace:
            frame = frame.open_namespace(str(self.evaluate_text(namespace, element, frame, "ns")))
        nodes: list[XmlNode] = []
        for root in self.included_roots(element, frame):
            with self.context.reading_file(root.evidence.file):
                nodes.extend(self.evaluate_children(root, frame.with_parent_attributes({})))
        return nodes

    def _is_call(self, element: XmlElement, frame: ElementScope) -> bool:
        """Tell whether an element without the prefix calls a macro.

        A macro's body may hold an element of the macro's own name, which does not.
        """
        found = find_macro(element.tag, frame)
        if found is None or any(found[0] is macro for macro in self.active_macros):
            return False
        return element.attributes.keys() <= set(found[0].parameters)

    def _call_macro(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        found = find_macro(element.tag.removeprefix(PREFIX), frame)
        with self.context.noting_errors(element):
            if found is None:
                raise ValueError("there is no macro of this name")
            if len(self.active_macros) == MAX_DEPTH:
                raise ValueError(f"macros call each other more than {MAX_DEPTH} deep")
            return self._expand_macro(element, frame, *found)
        return []

    def _expand_macro(
        self, element: XmlElement, frame: ElementScope, macro: XacroMacro, outer: ElementScope
    ) -> list[XmlNode]:
        inner = outer.macro_scope()
        bind_parameters(self.context, element, macro, frame, inner)
        blocks = self.evaluate_children(element, frame.with_parent_attributes({}))
        bind_blocks(self.context, element, macro, blocks, inner)
        self.active_macros.append(macro)
        try:
            return self.evaluate_children(macro.body, inner)
        finally:
            self.active_macros.pop()

    def _dynamic_call(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        attributes = dict(element.attributes)
        name = self.evaluate_text(attributes.pop("macro", ""), element, frame, "macro")
        return self._call_macro(
            replace(element, tag=f"{PREFIX}{name}", attributes=attributes), frame
        )

    def _element(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        attributes = dict(element.attributes)
        name = str(self.evaluate_text(attributes.pop(f"{PREFIX}name", ""), element, frame, "name"))
        if not _XML_NAME.fullmatch(name) or name == f"{PREFIX}element":
            self.context.add_unresolved(
                element, f"<{element.tag}>", f"'{name}' is no element's name"
            )
            return []
        return self.evaluate_node(replace(element, tag=name, attributes=attributes), frame)

    def _attribute(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        name, value = (
            str(self.evaluate_text(element.attributes.get(key, ""), element, frame, key))
            for key in ("name", "value")
        )
        if _XML_NAME.fullmatch(name):
            frame.parent_attributes[name] = value
        else:
            self.context.add_unresolved(
                element, f"<{element.tag}>", f"'{name}' is no attribute's name"
            )
        return []

    def _condition(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        text = element.attributes.get("value", "")
        with self.context.noting_errors(element, f"<{element.tag}> value: {text[:200]}"):
            holds = truth_value(self.context.evaluate_text(text, frame.symbols))
            unless = element.tag.removeprefix(PREFIX) == "unless"
            if holds is not unless:
                return self.evaluate_children(element, frame.with_parent_attributes({}))
        return []

    def _insert_block(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        name = element.attributes.get("name", "")
        with self.context.noting_errors(element, f"block {name}"):
            if f"**{name}" in frame.symbols:
                block = frame.symbols.get(f"**{name}", self.context.evaluate_text)
                return self.evaluate_children(block, frame.with_parent_attributes({}))
            if f"*{name}" in frame.symbols:
                return [
                    self.evaluate_element(
                        frame.symbols.get(f"*{name}", self.context.evaluate_text), frame
                    )
                ]
            raise ValueError("is not defined")
        return []

    def _argument(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        name, default = element.attributes.get("name", ""), element.attributes.get("default")
        if name not in self.context.arguments and default is not None:
            with self.context.noting_errors(element, f"argument {name}"):
                value = str(self.context.evaluate_text(default, frame.symbols))
                self.context.arguments[name] = value
        return []

    def _macro(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        name = element.attributes.get("name", "").removeprefix(PREFIX)
        frame.macros.set(name, read_macro(element), lazy=False)
        return []

    def _property(self, element: XmlElement, frame: ElementScope) -> list[XmlNode]:
        with self.context.noting_errors(element, f"property {element.attributes.get('name', '')}"):
            define_property(self.context, element, frame.symbols)
        return []

    handlers: ClassVar[Mapping[str, StatementHandler]] = {
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


def required_attribute(element: XmlElement, attribute: str) -> str:
    """Return an attribute; raise ValueError where it is not written."""
    if attribute not in element.attributes:
        raise ValueError(f"has no '{attribute}'")
    return element.attributes[attribute]

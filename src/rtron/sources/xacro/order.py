"""The order in which xacro evaluated before Melodic: all definitions first, wherever they stand.

Kinetic took in every include, then every macro, then every property, and evaluated what was left;
a macro could be called above its definition (ROS wiki: xacro, processing order).
"""

from dataclasses import replace

from rtron.sources.xacro.evaluator import XacroEvaluator
from rtron.sources.xacro.frame import ElementScope
from rtron.sources.xacro.statements import statement_name
from rtron.sources.xacro.xml_element import XmlElement, XmlNode

_DEFINITIONS = ("macro", "property")


def hoist_definitions(
    evaluator: XacroEvaluator, root: XmlElement, frame: ElementScope
) -> XmlElement:
    """Return a document without its includes, macros and properties; the frame has them then."""
    root = _with_includes(evaluator, root, frame)
    for kind in _DEFINITIONS:
        root = _without_definitions(evaluator, root, frame, kind)
    return root


def _with_includes(
    evaluator: XacroEvaluator, element: XmlElement, frame: ElementScope
) -> XmlElement:
    children: list[XmlNode] = []
    for child in element.children:
        if not isinstance(child, XmlElement):
            children.append(child)
        elif statement_name(child) == "include" and "ns" not in child.attributes:
            children.extend(_included_children(evaluator, child, frame))
        else:
            children.append(_with_includes(evaluator, child, frame))
    return replace(element, children=tuple(children))


def _included_children(
    evaluator: XacroEvaluator, include: XmlElement, frame: ElementScope
) -> list[XmlNode]:
    children: list[XmlNode] = []
    for root in evaluator.included_roots(include, frame):
        with evaluator.context.reading_file(root.evidence.file):
            children.extend(_with_includes(evaluator, root, frame).children)
    return children


def _without_definitions(
    evaluator: XacroEvaluator, element: XmlElement, frame: ElementScope, kind: str
) -> XmlElement:
    children: list[XmlNode] = []
    for child in element.children:
        if not isinstance(child, XmlElement):
            children.append(child)
        elif statement_name(child) == kind:
            evaluator.handlers[kind](evaluator, child, frame)
        else:
            children.append(_without_definitions(evaluator, child, frame, kind))
    return replace(element, children=tuple(children))

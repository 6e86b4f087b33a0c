"""The order in which xacro evaluated before Melodic: all definitions first, wherever they stand.

Kinetic took in every include, then every macro, then every property, and evaluated what was left;
a macro could be called above its definition (ROS wiki: xacro, processing order).
"""

from dataclasses import replace

from rtron.sources.xacro.evaluator import Evaluator
from rtron.sources.xacro.frame import Frame
from rtron.sources.xacro.statements import statement
from rtron.sources.xacro.xml_element import XmlElement, XmlNode

_DEFINITIONS = ("macro", "property")


def hoisted(evaluator: Evaluator, root: XmlElement, frame: Frame) -> XmlElement:
    """Return a document without its includes, macros and properties; the frame has them then."""
    root = _with_includes(evaluator, root, frame)
    for kind in _DEFINITIONS:
        root = _without(evaluator, root, frame, kind)
    return root


def _with_includes(evaluator: Evaluator, element: XmlElement, frame: Frame) -> XmlElement:
    children: list[XmlNode] = []
    for child in element.children:
        if not isinstance(child, XmlElement):
            children.append(child)
        elif statement(child) == "include" and "ns" not in child.attributes:
            children.extend(_taken_in(evaluator, child, frame))
        else:
            children.append(_with_includes(evaluator, child, frame))
    return replace(element, children=tuple(children))


def _taken_in(evaluator: Evaluator, include: XmlElement, frame: Frame) -> list[XmlNode]:
    children: list[XmlNode] = []
    for root in evaluator.included(include, frame):
        with evaluator.around.reading(root.evidence.file):
            children.extend(_with_includes(evaluator, root, frame).children)
    return children


def _without(evaluator: Evaluator, element: XmlElement, frame: Frame, kind: str) -> XmlElement:
    children: list[XmlNode] = []
    for child in element.children:
        if not isinstance(child, XmlElement):
            children.append(child)
        elif statement(child) == kind:
            evaluator.handlers[kind](evaluator, child, frame)
        else:
            children.append(_without(evaluator, child, frame, kind))
    return replace(element, children=tuple(children))

"""A xacro file as the robot description it stands for; nothing is executed."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.xacro.evaluation_context import EvaluationContext
from rtron.sources.xacro.evaluator import XacroEvaluator
from rtron.sources.xacro.scopes import ElementScope, PropertyScope
from rtron.sources.xacro.xml_element import (
    PREFIX,
    XmlElement,
    XmlNode,
    read_element,
    statement_name,
    xml_text,
)
from rtron.vocabulary import UnknownValue, UnresolvedItem

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


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroResult:
    """A description: its XML text, its elements with their locations, the rest.

    `files` are those it was read from; `unresolved` is what could not be evaluated and is left
    out, or stands as it is written.
    """

    text: str
    root: XmlElement
    files: tuple[str, ...] = ()
    unresolved: tuple[UnresolvedItem, ...] = ()


def evaluate_xacro(
    path: Path,
    args: Mapping[str, str],
    packages: PackageIndex,
    environ: Mapping[str, str] = os.environ,
) -> XacroResult:
    """Return what `xacro PATH name:=value …` would print (ROS wiki: xacro).

    A file is read in the order of its lines; where that leaves something undefined, in the order
    of Kinetic, if that leaves less. Raise InputError if the file itself is no XML.
    """
    path = path.absolute()
    root = read_element(path)
    contexts = [
        EvaluationContext(
            packages=packages, environ=environ, arguments=dict(args), open_files=[str(path)]
        )
        for _ in range(2)
    ]
    try:
        result = _evaluate(root, contexts[0], kinetic_order=False)
        if result.unresolved and not contexts[0].budget.exceeded_bound:
            older = _evaluate(root, contexts[1], kinetic_order=True)
            result = min(result, older, key=lambda each: len(each.unresolved))
    except RecursionError:
        raise InputError("is nested too deep", path=str(path)) from None
    return result


def _evaluate(root: XmlElement, context: EvaluationContext, *, kinetic_order: bool) -> XacroResult:
    context.add_namespaces(root)
    context.files_read.add(context.open_files[0])
    evaluator = XacroEvaluator(context=context)
    frame = ElementScope(symbols=PropertyScope(), macros=PropertyScope(), parent_attributes={})
    made = evaluator.evaluate_element(
        hoist_definitions(evaluator, root, frame) if kinetic_order else root, frame
    )
    namespaces = {k: v for k, v in context.namespaces.items() if k != f"xmlns:{PREFIX[:-1]}"}
    made = replace(made, attributes={**namespaces, **made.attributes})
    return XacroResult(
        text=xml_text(made),
        root=made,
        files=tuple(sorted(context.files_read)),
        unresolved=tuple(context.notes),
    )


_Key: TypeAlias = tuple[str, tuple[tuple[str, str], ...]]


@dataclass(slots=True, kw_only=True)
class RobotDescriptions:
    """Evaluates descriptions, each file with the same arguments once."""

    packages: PackageIndex
    environ: Mapping[str, str] = field(default_factory=lambda: os.environ)
    _results: dict[_Key, XacroResult | InputError] = field(default_factory=dict)
    _by_text: dict[str, XacroResult] = field(default_factory=dict)

    def describe(self, path: str | Path, args: Mapping[str, str]) -> str | UnknownValue:
        """Return what `xacro PATH name:=value …` would print, or why that is not known."""
        result = self.evaluate_file(path, args)
        return UnknownValue(str(result)) if isinstance(result, InputError) else result.text

    def evaluate_file(self, path: str | Path, args: Mapping[str, str]) -> XacroResult | InputError:
        """Return the description of a file, or what is wrong with the file."""
        key = (str(path), tuple(sorted(args.items())))
        if key not in self._results:
            self._results[key] = self._evaluate(Path(path), args)
        return self._results[key]

    def result_of_text(self, text: str) -> XacroResult | None:
        """Return the description whose text `describe` gave, None if it was another's."""
        return self._by_text.get(text)

    def results(self) -> tuple[XacroResult, ...]:
        """Return every description evaluated so far, in the order of the first demand."""
        return tuple(each for each in self._results.values() if isinstance(each, XacroResult))

    def _evaluate(self, path: Path, args: Mapping[str, str]) -> XacroResult | InputError:
        try:
            result = evaluate_xacro(path, args, self.packages, self.environ)
        except InputError as error:
            return error
        self._by_text.setdefault(result.text, result)
        return result

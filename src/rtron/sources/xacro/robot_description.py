"""A xacro file as the robot description it stands for; nothing is executed."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.xacro.evaluation_context import EvaluationContext
from rtron.sources.xacro.evaluator import XacroEvaluator
from rtron.sources.xacro.frame import ElementScope
from rtron.sources.xacro.order import hoist_definitions
from rtron.sources.xacro.scopes import PropertyScope
from rtron.sources.xacro.statements import PREFIX
from rtron.sources.xacro.xml_element import XmlElement, read_element, xml_text
from rtron.vocabulary import UnresolvedItem


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroResult:
    """A description: its XML text, its elements with the places they were written at, the rest.

    `open_files` are those it was read from; `unresolved` is what could not be evaluated and is left
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

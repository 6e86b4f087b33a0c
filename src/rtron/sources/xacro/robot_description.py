"""A xacro file as the robot description it stands for; nothing is executed."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.xacro.evaluation_context import Surroundings
from rtron.sources.xacro.evaluator import Evaluator
from rtron.sources.xacro.frame import Frame
from rtron.sources.xacro.order import hoisted
from rtron.sources.xacro.scopes import Scope
from rtron.sources.xacro.statements import PREFIX
from rtron.sources.xacro.xml_element import XmlElement, read_element, xml_text
from rtron.vocabulary import Unresolved


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroResult:
    """A description: its XML text, its elements with the places they were written at, the rest.

    `files` are those it was read from; `unresolved` is what could not be evaluated and is left
    out, or stands as it is written.
    """

    text: str
    root: XmlElement
    files: tuple[str, ...] = ()
    unresolved: tuple[Unresolved, ...] = ()


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
    surroundings = [
        Surroundings(packages=packages, environ=environ, arguments=dict(args), files=[str(path)])
        for _ in range(2)
    ]
    try:
        result = _evaluated(root, surroundings[0], old=False)
        if result.unresolved and not surroundings[0].budget.exhausted:
            older = _evaluated(root, surroundings[1], old=True)
            result = min(result, older, key=lambda each: len(each.unresolved))
    except RecursionError:
        raise InputError("is nested too deep", path=str(path)) from None
    return result


def _evaluated(root: XmlElement, around: Surroundings, *, old: bool) -> XacroResult:
    around.declare(root)
    around.read.add(around.files[0])
    evaluator = Evaluator(around=around)
    frame = Frame(symbols=Scope(), macros=Scope(), owner={})
    made = evaluator.plain(hoisted(evaluator, root, frame) if old else root, frame)
    namespaces = {k: v for k, v in around.namespaces.items() if k != f"xmlns:{PREFIX[:-1]}"}
    made = replace(made, attributes={**namespaces, **made.attributes})
    return XacroResult(
        text=xml_text(made),
        root=made,
        files=tuple(sorted(around.read)),
        unresolved=tuple(around.notes),
    )

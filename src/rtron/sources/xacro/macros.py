"""Finding the macro that an element calls, and giving its parameters their values."""

from collections.abc import Iterable, Mapping

from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.evaluation_context import EvaluationContext
from rtron.sources.xacro.frame import ElementScope
from rtron.sources.xacro.macro import ParameterDefault, XacroMacro
from rtron.sources.xacro.scopes import PropertyScope
from rtron.sources.xacro.xml_element import XMLNS, XmlElement


def find_macro(name: str, frame: ElementScope) -> tuple[XacroMacro, ElementScope] | None:
    """Return the macro called `name` or `namespace.name`, and the frame that its body sees."""
    macro = _visible_value(frame.macros, name)
    if isinstance(macro, XacroMacro):
        return macro, frame
    *namespaces, last = name.split(".")
    symbols, macros = frame.symbols, frame.macros
    for namespace in namespaces:
        inner, below = _visible_value(macros, namespace), _visible_value(symbols, namespace)
        if not isinstance(inner, PropertyScope) or not isinstance(below, PropertyScope):
            return None
        symbols, macros = below, inner
    macro = _visible_value(macros, last)
    found = ElementScope(symbols=symbols, macros=macros, parent_attributes=frame.parent_attributes)
    return (macro, found) if isinstance(macro, XacroMacro) else None


def bind_parameters(
    around: EvaluationContext,
    element: XmlElement,
    macro: XacroMacro,
    frame: ElementScope,
    inner: ElementScope,
) -> None:
    """Set a call's parameters in `inner`, evaluated in `frame`; note what is not as it must be."""
    given = {k: v for k, v in element.attributes.items() if not k.startswith(XMLNS)}
    for name in given.keys() - set(macro.parameters):
        around.add_unresolved(element, f"<{element.tag}>", f"the macro has no parameter '{name}'")
    for name in macro.parameters:
        if name.startswith("*"):
            continue
        with around.noting_errors(element, f"<{element.tag}> parameter {name}"):
            inner.symbols.set(name, _parameter_value(around, name, given, macro, frame), lazy=False)


def bind_blocks(
    around: EvaluationContext,
    element: XmlElement,
    macro: XacroMacro,
    blocks: Iterable[object],
    inner: ElementScope,
) -> None:
    """Set a call's blocks in `inner`, in order; note one too few or too many."""
    given = [block for block in blocks if isinstance(block, XmlElement)]
    for name, block in zip(macro.blocks, given, strict=False):
        inner.symbols.set(name, block, lazy=False)
    if len(given) != len(macro.blocks):
        why = f"the macro takes {len(macro.blocks)} blocks, {len(given)} are given"
        around.add_unresolved(element, f"<{element.tag}>", why)


def _parameter_value(
    around: EvaluationContext,
    name: str,
    given: Mapping[str, str],
    macro: XacroMacro,
    frame: ElementScope,
) -> Value:
    if name in given:
        return around.evaluate_text(given[name], frame.symbols)
    default = macro.defaults.get(name, ParameterDefault(text=None))
    if default.is_forwarded and name in frame.symbols:
        return frame.symbols.get(name, around.evaluate_text)
    if default.text is None:
        raise ValueError("has no value")
    return around.evaluate_text(default.text, frame.symbols)


def _visible_value(scope: PropertyScope, name: str) -> Value:
    return next(
        (each.values[name] for each in scope.enclosing_scopes() if name in each.values), None
    )

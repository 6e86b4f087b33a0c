"""Finding the macro that an element calls, and giving its parameters their values."""

from collections.abc import Iterable, Mapping

from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.evaluation_context import Surroundings
from rtron.sources.xacro.frame import Frame
from rtron.sources.xacro.macro import Default, Macro
from rtron.sources.xacro.scopes import Scope
from rtron.sources.xacro.xml_element import XMLNS, XmlElement


def find_macro(name: str, frame: Frame) -> tuple[Macro, Frame] | None:
    """Return the macro called `name` or `namespace.name`, and the frame that its body sees."""
    macro = _known(frame.macros, name)
    if isinstance(macro, Macro):
        return macro, frame
    *namespaces, last = name.split(".")
    symbols, macros = frame.symbols, frame.macros
    for namespace in namespaces:
        inner, below = _known(macros, namespace), _known(symbols, namespace)
        if not isinstance(inner, Scope) or not isinstance(below, Scope):
            return None
        symbols, macros = below, inner
    macro = _known(macros, last)
    found = Frame(symbols=symbols, macros=macros, owner=frame.owner)
    return (macro, found) if isinstance(macro, Macro) else None


def bind_parameters(
    around: Surroundings, element: XmlElement, macro: Macro, frame: Frame, inner: Frame
) -> None:
    """Set a call's parameters in `inner`, evaluated in `frame`; note what is not as it must be."""
    given = {k: v for k, v in element.attributes.items() if not k.startswith(XMLNS)}
    for name in given.keys() - set(macro.parameters):
        around.note(element, f"<{element.tag}>", f"the macro has no parameter '{name}'")
    for name in macro.parameters:
        if name.startswith("*"):
            continue
        with around.noting(element, f"<{element.tag}> parameter {name}"):
            inner.symbols.set(name, _parameter(around, name, given, macro, frame), lazy=False)


def bind_blocks(
    around: Surroundings, element: XmlElement, macro: Macro, blocks: Iterable[object], inner: Frame
) -> None:
    """Set a call's blocks in `inner`, in order; note one too few or too many."""
    given = [block for block in blocks if isinstance(block, XmlElement)]
    for name, block in zip(macro.blocks, given, strict=False):
        inner.symbols.set(name, block, lazy=False)
    if len(given) != len(macro.blocks):
        why = f"the macro takes {len(macro.blocks)} blocks, {len(given)} are given"
        around.note(element, f"<{element.tag}>", why)


def _parameter(
    around: Surroundings, name: str, given: Mapping[str, str], macro: Macro, frame: Frame
) -> Value:
    if name in given:
        return around.value(given[name], frame.symbols)
    default = macro.defaults.get(name, Default(text=None))
    if default.forward and name in frame.symbols:
        return frame.symbols.get(name, around.value)
    if default.text is None:
        raise ValueError("has no value")
    return around.value(default.text, frame.symbols)


def _known(scope: Scope, name: str) -> Value:
    return next((each.values[name] for each in scope.chain() if name in each.values), None)

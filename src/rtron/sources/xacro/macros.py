"""Finding the macro that an element calls, and giving its parameters their values."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.evaluation_context import EvaluationContext
from rtron.sources.xacro.scopes import ElementScope, PropertyScope
from rtron.sources.xacro.xml_element import XMLNS, XmlElement

_DEFAULT = re.compile(
    r"\s*(?P<name>[^\s:=]+?)\s*:?=\s*(?P<forward>\^\|?)?"
    r"(?P<default>\$\{[^}]*\}|\$\([^)]*\)|(?:'[^']*'|\"[^\"]*\"|[^\s'\"])+|)(?:\s+|$)"
)
_PLAIN = re.compile(r"\s*(\S+)\s*")


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterDefault:
    """A parameter's default: the caller's property of the same name (`is_forwarded`), or a text."""

    text: str | None
    is_forwarded: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroMacro:
    """A macro; its block parameters are those whose names begin with `*`."""

    body: XmlElement
    parameters: tuple[str, ...]
    defaults: dict[str, ParameterDefault] = field(default_factory=dict)

    @property
    def blocks(self) -> tuple[str, ...]:
        """The block parameters, in order."""
        return tuple(name for name in self.parameters if name.startswith("*"))


def read_macro(body: XmlElement) -> XacroMacro:
    """Return what a `<xacro:macro>` defines."""
    names: list[str] = []
    defaults: dict[str, ParameterDefault] = {}
    text = body.attributes.get("params", "")
    position = 0
    while text[position:].strip():
        match = _DEFAULT.match(text, position) or _PLAIN.match(text, position)
        if match is None:
            break
        names.append(match[1])
        if match.re is _DEFAULT:
            forward = match["forward"] is not None
            if match["default"] or forward:
                defaults[match[1]] = ParameterDefault(
                    text=match["default"] or None, is_forwarded=forward
                )
        position = match.end()
    return XacroMacro(body=body, parameters=tuple(names), defaults=defaults)


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

"""Properties by name: a scope for the file, one within for each macro that is expanded.

A property's text is evaluated at its first use, in the scope where it is defined (ROS wiki: xacro,
property; a namespace is a scope with a name).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias

from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.xml_element import XmlElement

if TYPE_CHECKING:
    from rtron.sources.xacro.evaluation_context import EvaluationContext

Evaluate: TypeAlias = Callable[[str, "PropertyScope"], Value]

_BOOLEANS = {"true": True, "True": True, "false": False, "False": False}


@dataclass(slots=True, kw_only=True, eq=False)
class PropertyScope:
    """Names and their values; what is not here is looked for in `parent`."""

    parent: "PropertyScope | None" = None
    is_namespace: bool = False
    values: dict[str, Value] = field(default_factory=dict)
    lazy: set[str] = field(default_factory=set)
    _resolving: list[str] = field(default_factory=list)

    def set(self, name: str, value: Value, *, lazy: bool) -> None:
        """Give a name its value; a text that is no literal waits for its first use if `lazy`."""
        self.values[name] = literal_value(value)
        if lazy and isinstance(self.values[name], str):
            self.lazy.add(name)
        else:
            self.lazy.discard(name)

    def get(self, name: str, evaluate: Evaluate) -> Value:
        """Return a value; raise KeyError if there is none, ValueError if it needs itself."""
        for scope in self.enclosing_scopes():
            if name in scope.values:
                return scope._resolve(name, evaluate)  # noqa: SLF001 - one of us
        raise KeyError(name)

    def __contains__(self, name: str) -> bool:
        return any(name in scope.values for scope in self.enclosing_scopes())

    def remove(self, name: str) -> None:
        """Take a name out of this scope and those around it."""
        for scope in self.enclosing_scopes():
            scope.values.pop(name, None)
            scope.lazy.discard(name)

    def enclosing_scopes(self) -> "Iterator[PropertyScope]":
        """Yield this scope and those around it, innermost first."""
        scope: PropertyScope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    def caller_scope(self) -> "PropertyScope | None":
        """Return the scope that `scope="parent"` means; None at the top."""
        scope = self.parent
        while scope is not None and scope.is_namespace and not self.is_namespace:
            scope = scope.parent
        return scope

    def _resolve(self, name: str, evaluate: Evaluate) -> Value:
        if name in self.lazy:
            if name in self._resolving:
                raise ValueError("circular property: " + " -> ".join((*self._resolving, name)))
            self._resolving.append(name)
            try:
                self.values[name] = literal_value(evaluate(self.values[name], self))
            finally:
                self._resolving.remove(name)
            self.lazy.discard(name)
        return self.values[name]


@dataclass(frozen=True, slots=True)
class NamespaceView:
    """An included file's scope as an expression sees it: `namespace.property`."""

    scope: PropertyScope
    evaluate: Evaluate

    def __getitem__(self, name: str) -> Value:
        return self.scope.get(name, self.evaluate)


def literal_value(value: Value) -> Value:
    """Return a number or truth that a text spells, without the quotes of a quoted text."""
    if not isinstance(value, str):
        return value
    if len(value) > 1 and value[0] == value[-1] == "'":
        return value[1:-1]
    if "_" in value:
        return value
    number = _number(value, int)
    number = _number(value, float) if number is None else number
    return _BOOLEANS.get(value, value) if number is None else number


def truth_value(value: Value) -> bool:
    """Return what a condition's value says; raise ValueError if it says neither."""
    if isinstance(value, str):
        return _BOOLEANS[value] if value in _BOOLEANS else bool(int(value))
    return bool(value)


def _number(text: str, kind: type[int | float]) -> int | float | None:
    try:
        return kind(text)
    except ValueError:
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementScope:
    """The properties and macros in force, and the attributes of the element around."""

    symbols: PropertyScope
    macros: PropertyScope
    parent_attributes: dict[str, str]

    def with_parent_attributes(self, attributes: dict[str, str]) -> "ElementScope":
        """Return the frame of an element's contents; `<xacro:attribute>` adds to `attributes`."""
        return replace(self, parent_attributes=attributes)

    def macro_scope(self) -> "ElementScope":
        """Return the frame of a macro's body."""
        return ElementScope(
            symbols=PropertyScope(parent=self.symbols),
            macros=PropertyScope(parent=self.macros),
            parent_attributes={},
        )

    def open_namespace(self, namespace: str) -> "ElementScope":
        """Open a namespace in this frame and return the frame within."""
        symbols = PropertyScope(parent=self.symbols, is_namespace=True)
        macros = PropertyScope(is_namespace=True)
        self.symbols.set(namespace, symbols, lazy=False)
        self.macros.set(namespace, macros, lazy=False)
        return ElementScope(
            symbols=symbols, macros=macros, parent_attributes=self.parent_attributes
        )


def define_property(
    around: "EvaluationContext", element: XmlElement, symbols: PropertyScope
) -> None:
    """Set what a `<xacro:property>` defines, in the scope that it names.

    Raise ValueError if it is none, and what evaluating it raises.
    """
    name = str(around.evaluate_text(element.attributes.get("name", ""), symbols))
    if not name.isidentifier() or name.startswith("__"):
        raise ValueError(f"'{name}' is no name of a property")
    if truth_value(around.evaluate_text(element.attributes.get("remove", "false"), symbols)):
        symbols.remove(name)
        return
    value, default = element.attributes.get("value"), element.attributes.get("default")
    if default is not None and name in symbols:
        return
    target = _target(element, symbols)
    text = default if value is None else value
    if text is None:
        target.set(f"**{name}", element, lazy=False)
        return
    lazy = target is symbols and truth_value(
        around.evaluate_text(element.attributes.get("lazy_eval", "true"), symbols)
    )
    target.set(name, text if lazy else around.evaluate_text(text, symbols), lazy=lazy)


def _target(element: XmlElement, symbols: PropertyScope) -> PropertyScope:
    scope = element.attributes.get("scope")
    if scope == "global":
        return list(symbols.enclosing_scopes())[-1]
    if scope == "parent":
        caller = symbols.caller_scope()
        if caller is None:
            raise ValueError("has no parent scope")
        return caller
    return symbols

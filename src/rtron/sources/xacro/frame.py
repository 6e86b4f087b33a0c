"""What is in force where an element is evaluated."""

from dataclasses import dataclass, replace

from rtron.sources.xacro.scopes import PropertyScope


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

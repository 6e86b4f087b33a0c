"""What is in force where an element is evaluated."""

from dataclasses import dataclass, replace

from rtron.sources.xacro.scopes import Scope


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """The properties and macros in force, and the attributes of the element around."""

    symbols: Scope
    macros: Scope
    owner: dict[str, str]

    def owned_by(self, attributes: dict[str, str]) -> "Frame":
        """Return the frame of an element's contents; `<xacro:attribute>` adds to `attributes`."""
        return replace(self, owner=attributes)

    def inner(self) -> "Frame":
        """Return the frame of a macro's body."""
        return Frame(symbols=Scope(parent=self.symbols), macros=Scope(parent=self.macros), owner={})

    def named(self, namespace: str) -> "Frame":
        """Open a namespace in this frame and return the frame within."""
        symbols = Scope(parent=self.symbols, is_namespace=True)
        macros = Scope(is_namespace=True)
        self.symbols.set(namespace, symbols, lazy=False)
        self.macros.set(namespace, macros, lazy=False)
        return Frame(symbols=symbols, macros=macros, owner=self.owner)

"""Declarators: what stands around a declared name, `*`, `&`, `[n]`, `(params)`."""

from collections.abc import Iterator
from dataclasses import dataclass

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext
from rtron.sources.code.frontends.cpp.types import one_line_text
from rtron.sources.code.ir import TypeRef

_INNER = {
    *("pointer_declarator", "reference_declarator", "array_declarator", "function_declarator"),
    *("parenthesized_declarator", "attributed_declarator", "variadic_declarator"),
    *("init_declarator", "pointer_type_declarator"),
}
_POINTERS = {"pointer_declarator", "abstract_pointer_declarator", "pointer_type_declarator"}
_REFERENCES = {"reference_declarator", "abstract_reference_declarator"}


@dataclass(slots=True)
class Declarator:
    """A declared name (None where it is abstract) and what it is made of.

    `function` is the node with the parameters where a function is declared. `is_const_pointer`
    marks a pointer that always points at the same object, `* const`.
    """

    name: Node | None = None
    value: Node | None = None
    function: Node | None = None
    pointer: bool = False
    is_const_pointer: bool = False
    reference: bool = False
    sizes: tuple[Node | None, ...] = ()

    def array_type(self, context: LoweringContext, element: TypeRef | None) -> TypeRef | None:
        """Return the type with the array that the declarator makes of it."""
        for size in self.sizes:
            text = one_line_text(context, size) if size else ""
            element = TypeRef("array", (element or TypeRef("auto"), TypeRef(text)))
        return element


def read_declarator(node: Node | None) -> Declarator:
    """Return what a declarator's node says."""
    found = Declarator()
    while node is not None:
        kind = node.type
        if kind == "init_declarator":
            found.value = node.child_by_field_name("value")
        elif kind == "array_declarator":
            found.sizes = (*found.sizes, node.child_by_field_name("size"))
        elif kind == "function_declarator":
            found.function = node
        elif kind in _POINTERS:
            found.pointer = True
            found.is_const_pointer = any(child.text == b"const" for child in node.named_children)
            found.function = None
        elif kind in _REFERENCES:
            found.reference = True
        if kind not in _INNER:
            found.name = None if kind.startswith("abstract_") else node
            return found
        node = _inner(node)
    return found


def _inner(node: Node) -> Node | None:
    inner = node.child_by_field_name("declarator")
    if inner is None:
        named = [child for child in node.named_children if child.type not in _QUALIFIERS]
        inner = named[0] if named else None
    return inner


_QUALIFIERS = {"type_qualifier", "ms_based_modifier", "attribute_declaration", "parameter_list"}


def fields_of(node: Node) -> Iterator[tuple[str | None, Node]]:
    """Yield a node's named children with the names of their fields."""
    cursor = node.walk()
    more = cursor.goto_first_child()
    while more:
        child = cursor.node
        if child is not None and child.is_named:
            yield cursor.field_name, child
        more = cursor.goto_next_sibling()


def has_specifier(context: LoweringContext, node: Node, kind: str, word: bytes) -> bool:
    """Return whether a word of a kind (`type_qualifier`: `const`) stands in a declaration."""
    if context.source.find(word, node.start_byte, node.end_byte) < 0:
        return False
    return any(
        child.type == kind and context.source[child.start_byte : child.end_byte] == word
        for child in node.named_children
    )


def is_constant(context: LoweringContext, node: Node, found: Declarator) -> bool:
    """Return whether a declared name always has the same value.

    Of a pointer the text that it points at is its value, so both have to be constant.
    """
    const = has_specifier(context, node, "type_qualifier", b"const")
    constexpr = has_specifier(context, node, "type_qualifier", b"constexpr")
    if found.pointer:
        return const and (found.is_const_pointer or constexpr)
    return const or (constexpr and not found.reference)

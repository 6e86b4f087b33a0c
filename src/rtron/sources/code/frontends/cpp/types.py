"""Types and qualified names as they are written, their template arguments taken out."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext
from rtron.sources.code.ir import TypeRef

Types = tuple[TypeRef, ...]
_MAX_ARGUMENTS = 64
_NAMED_TEMPLATES = {"template_type", "template_function", "template_method"}
_IDENTIFIERS = {"identifier", "field_identifier", "type_identifier", "namespace_identifier"}
_SPECIFIERS = {"struct_specifier", "class_specifier", "union_specifier", "enum_specifier"}
_DEDUCED = {"placeholder_type_specifier", "auto", "decltype"}


def type_of(context: LoweringContext, node: Node | None) -> TypeRef | None:
    """Return the type that a node names, None for `auto`, `decltype` and where there is none."""
    if node is None or node.type in _DEDUCED:
        return None
    if node.type in _SPECIFIERS:
        return _specifier_type(context, node)
    key = context.source[node.start_byte : node.end_byte]
    if key not in context.types:
        context.types[key] = _read_type(context, node)
    return context.types[key]


def _read_type(context: LoweringContext, node: Node) -> TypeRef | None:
    kind = node.type
    if kind == "type_descriptor":
        return _descriptor_type(context, node)
    if kind in {"dependent_type", "attributed_type"} and node.named_children:
        return type_of(context, node.named_children[0])
    return TypeRef(*qualified_name(context, node))


def _specifier_type(context: LoweringContext, node: Node) -> TypeRef | None:
    name = node.child_by_field_name("name")
    return type_of(context, name) if name else TypeRef(anonymous_name(node))


def anonymous_name(node: Node) -> str:
    """Return the name given to a class or enum without one, by its line."""
    return f"{node.type.split('_')[0]}@{node.start_point[0] + 1}"


def _descriptor_type(context: LoweringContext, node: Node) -> TypeRef | None:
    declarator = node.child_by_field_name("declarator")
    while declarator is not None and declarator.type != "abstract_function_declarator":
        declarator = declarator.child_by_field_name("declarator")
    if declarator is not None:
        return TypeRef(one_line_text(context, node))
    return type_of(context, node.child_by_field_name("type"))


def one_line_text(context: LoweringContext, node: Node) -> str:
    """Return a node's text on one line, bounded."""
    return " ".join(context.text(node)[:200].split())


def qualified_name(context: LoweringContext, node: Node | None) -> tuple[str, Types]:
    """Return a name, qualified as it is written, and the last template arguments in it."""
    if node is not None and node.type in _IDENTIFIERS:
        return _plain(context, node), ()
    parts: list[str] = []
    types: Types = ()
    while node is not None and node.type == "qualified_identifier":
        scope = node.child_by_field_name("scope")
        if scope is not None:
            parts.append(_part(context, scope))
            types = template_arguments(context, scope) or types
        node = node.child_by_field_name("name")
    node = _without_dependent(node)
    if node is not None:
        parts.append(_part(context, node))
        types = template_arguments(context, node) or types
    return "::".join(parts), types


def _without_dependent(node: Node | None) -> Node | None:
    while node is not None and node.type in {"dependent_name", "dependent_type"}:
        node = node.named_children[0] if node.named_children else None
    return node


def _part(context: LoweringContext, node: Node) -> str:
    if node.type in _NAMED_TEMPLATES:
        name = node.child_by_field_name("name")
        return _part(context, name) if name else ""
    return _NAME_SPELLINGS.get(node.type, _plain)(context, node)


def _plain(context: LoweringContext, node: Node) -> str:
    return context.source[node.start_byte : node.end_byte].decode("utf-8", "replace")


def _operator(context: LoweringContext, node: Node) -> str:
    words = one_line_text(context, node).removeprefix("operator").strip()
    return f"operator {words}" if words[:1].isalpha() else f"operator{words.replace(' ', '')}"


def _conversion(context: LoweringContext, node: Node) -> str:
    return f"operator {type_of(context, node.child_by_field_name('type'))}"


def _destructor(context: LoweringContext, node: Node) -> str:
    return _plain(context, node).replace(" ", "")


_NAME_SPELLINGS: dict[str, Callable[[LoweringContext, Node], str]] = {
    "operator_name": _operator,
    "operator_cast": _conversion,
    "destructor_name": _destructor,
    "sized_type_specifier": one_line_text,
}


def template_arguments(context: LoweringContext, node: Node) -> Types:
    """Return the template arguments that a name has; a value stands as its text."""
    if node.type not in _NAMED_TEMPLATES:
        return ()
    arguments = node.child_by_field_name("arguments")
    if arguments is None or context.is_too_deep(node):
        return ()
    context.depth += 1
    types = [_argument(context, child) for child in arguments.named_children[:_MAX_ARGUMENTS]]
    context.depth -= 1
    return tuple(types)


def specialised_name(name: str, types: Types) -> str:
    """Return the name of a class that is specialised for types: `T<int>`, without `::` in them."""
    return f"{name}<{', '.join(map(str, types)).replace('::', '.')}>" if types else name


def _argument(context: LoweringContext, node: Node) -> TypeRef:
    given = type_of(context, node) if _may_be_type(node) else None
    return given or TypeRef(one_line_text(context, node))


def _may_be_type(node: Node) -> bool:
    """Tell whether a template argument is a type; the grammar takes some `A<B>` for functions."""
    last: Node | None = node
    while last is not None and last.type == "qualified_identifier":
        last = last.child_by_field_name("name")
    return node.type == "type_descriptor" or (last is not None and last.type in _NAMED_TEMPLATES)


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

"""Expressions of C++: names, members, calls, values that are made."""

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.literals import number, string
from rtron.sources.code.frontends.cpp.lowering_context import Context, line_of
from rtron.sources.code.frontends.cpp.node_lowering import expression, expressions, lowers, opaque
from rtron.sources.code.frontends.cpp.types import named, type_of
from rtron.sources.code.ir import (
    Attr,
    Call,
    Const,
    Expr,
    Index,
    Name,
    New,
    Opaque,
    Sequence,
    Star,
    TypeRef,
)

_CASTS = {"static_cast", "dynamic_cast", "const_cast", "reinterpret_cast"}
_MAX_ITEMS = 4096


@lowers(
    "identifier",
    "field_identifier",
    "type_identifier",
    "namespace_identifier",
    "this",
    "primitive_type",
    "sized_type_specifier",
    "auto",
)
def name(context: Context, node: Node) -> Expr:
    """Return a Name, one object for each name of a file."""
    key = context.source[node.start_byte : node.end_byte]
    known = context.names.get(key)
    if known is None:
        known = context.names[key] = Name(key.decode("utf-8", "replace"))
    return known


@lowers(
    "qualified_identifier",
    "template_function",
    "template_type",
    "template_method",
    "dependent_name",
    "operator_name",
    "destructor_name",
)
def _qualified(context: Context, node: Node) -> Expr:
    return Name(*named(context, node))


@lowers("string_literal", "raw_string_literal", "char_literal")
def _string(context: Context, node: Node) -> Expr:
    return Const(string(context.text(node)))


@lowers("concatenated_string")
def _concatenated(context: Context, node: Node) -> Expr:
    parts = expressions(context, node.named_children)
    texts = [part.value for part in parts if isinstance(part, Const)]
    if len(texts) < len(parts):
        return Opaque(parts, context.text(node)[:60])
    return Const("".join(map(str, texts)))


@lowers("number_literal")
def _number(context: Context, node: Node) -> Expr:
    value = number(context.text(node))
    return opaque(context, node) if value is None else Const(value)


@lowers("true", "false")
def _bool(_context: Context, node: Node) -> Expr:
    return Const(node.type == "true")


@lowers("null", "nullptr")
def _null(_context: Context, _node: Node) -> Expr:
    return Const(None)


@lowers(
    "user_defined_literal", "parenthesized_expression", "condition_clause", "co_await_expression"
)
def _first(context: Context, node: Node) -> Expr:
    children = node.named_children
    return expression(context, children[0]) if children else opaque(context, node)


@lowers("pointer_expression", "cast_expression")
def _dissolved(context: Context, node: Node) -> Expr:
    inner = node.child_by_field_name("argument") or node.child_by_field_name("value")
    return expression(context, inner) if inner else opaque(context, node)


@lowers("field_expression")
def _member(context: Context, node: Node) -> Expr:
    owner = node.child_by_field_name("argument")
    field = node.child_by_field_name("field")
    if owner is None or field is None:
        return opaque(context, node)
    return Attr(expression(context, owner), *named(context, field))


@lowers("subscript_expression")
def _element(context: Context, node: Node) -> Expr:
    owner = node.child_by_field_name("argument")
    indices = node.child_by_field_name("indices")
    if owner is None or indices is None:
        return opaque(context, node)
    keys = expressions(context, indices.named_children)
    key = keys[0] if len(keys) == 1 else Sequence(keys, "tuple")
    return Index(expression(context, owner), key)


@lowers("call_expression")
def _call(context: Context, node: Node) -> Expr:
    function = node.child_by_field_name("function")
    if function is None:
        return opaque(context, node)
    args = arguments(context, node.child_by_field_name("arguments"))
    if function.type == "template_function" and len(args) == 1:
        cast = function.child_by_field_name("name")
        if cast is not None and context.text(cast) in _CASTS:
            return args[0]
    return Call(expression(context, function), args, (), line_of(node))


def arguments(context: Context, node: Node | None) -> tuple[Expr, ...]:
    """Return the expressions of an argument or initialiser list."""
    if node is None:
        return ()
    if node.type in {"argument_list", "initializer_list"}:
        return expressions(context, node.named_children[:_MAX_ITEMS])
    return (expression(context, node),)


@lowers("initializer_list")
def _list(context: Context, node: Node) -> Expr:
    return Sequence(arguments(context, node))


@lowers("initializer_pair")
def _designated(context: Context, node: Node) -> Expr:
    value = node.child_by_field_name("value")
    return expression(context, value) if value else opaque(context, node)


@lowers("compound_literal_expression")
def _literal(context: Context, node: Node) -> Expr:
    type = type_of(context, node.child_by_field_name("type")) or TypeRef("auto")
    return New(type, arguments(context, node.child_by_field_name("value")), line_of(node))


@lowers("new_expression")
def _new(context: Context, node: Node) -> Expr:
    type = type_of(context, node.child_by_field_name("type")) or TypeRef("auto")
    array = node.child_by_field_name("declarator")
    if array is not None:
        length = array.child_by_field_name("length")
        type = TypeRef("array", (type, TypeRef(context.text(length)[:60] if length else "")))
    return New(type, arguments(context, node.child_by_field_name("arguments")), line_of(node))


@lowers("parameter_pack_expansion")
def _pack(context: Context, node: Node) -> Expr:
    pattern = node.child_by_field_name("pattern")
    return Star(expression(context, pattern)) if pattern else opaque(context, node)


@lowers("sizeof_expression", "alignof_expression", "offsetof_expression", "fold_expression")
def _unknown(context: Context, node: Node) -> Expr:
    return Opaque((), context.text(node)[:60])

"""Expressions of C++: names, members, calls, values that are made."""

from collections.abc import Iterator

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.literals import number_value, string_value
from rtron.sources.code.frontends.cpp.lowering_context import (
    LoweringContext,
    line_of,
    lower_expression,
    lower_expressions,
    lower_opaque,
    lowers_expression,
)
from rtron.sources.code.frontends.cpp.types import qualified_name, type_of

_CASTS = {"static_cast", "dynamic_cast", "const_cast", "reinterpret_cast"}
_MAX_ITEMS = 4096
_BIND = ir.Name("std::bind")


@lowers_expression(
    "identifier",
    "field_identifier",
    "type_identifier",
    "namespace_identifier",
    "this",
    "primitive_type",
    "sized_type_specifier",
    "auto",
)
def name(context: LoweringContext, node: Node) -> ir.Expr:
    """Return a Name, one object for each name of a file."""
    key = context.source[node.start_byte : node.end_byte]
    known = context.names.get(key)
    if known is None:
        known = context.names[key] = ir.Name(key.decode("utf-8", "replace"))
    return known


@lowers_expression(
    "qualified_identifier",
    "template_function",
    "template_type",
    "template_method",
    "dependent_name",
    "operator_name",
    "destructor_name",
)
def _qualified(context: LoweringContext, node: Node) -> ir.Expr:
    return ir.Name(*qualified_name(context, node))


@lowers_expression("string_literal", "raw_string_literal", "char_literal")
def _string(context: LoweringContext, node: Node) -> ir.Expr:
    return ir.Const(string_value(context.text(node)))


@lowers_expression("concatenated_string")
def _concatenated(context: LoweringContext, node: Node) -> ir.Expr:
    parts = lower_expressions(context, node.named_children)
    texts = [part.value for part in parts if isinstance(part, ir.Const)]
    if len(texts) < len(parts):
        return ir.Opaque(parts, context.text(node)[:60])
    return ir.Const("".join(map(str, texts)))


@lowers_expression("number_literal")
def _number(context: LoweringContext, node: Node) -> ir.Expr:
    value = number_value(context.text(node))
    return lower_opaque(context, node) if value is None else ir.Const(value)


@lowers_expression("true", "false")
def _bool(_context: LoweringContext, node: Node) -> ir.Expr:
    return ir.Const(node.type == "true")


@lowers_expression("null", "nullptr")
def _null(_context: LoweringContext, _node: Node) -> ir.Expr:
    return ir.Const(None)


@lowers_expression(
    "user_defined_literal", "parenthesized_expression", "condition_clause", "co_await_expression"
)
def _inner_expression(context: LoweringContext, node: Node) -> ir.Expr:
    children = node.named_children
    return lower_expression(context, children[0]) if children else lower_opaque(context, node)


@lowers_expression("pointer_expression", "cast_expression")
def _operand(context: LoweringContext, node: Node) -> ir.Expr:
    inner = node.child_by_field_name("argument") or node.child_by_field_name("value")
    return lower_expression(context, inner) if inner else lower_opaque(context, node)


@lowers_expression("field_expression")
def _member(context: LoweringContext, node: Node) -> ir.Expr:
    owner = node.child_by_field_name("argument")
    field = node.child_by_field_name("field")
    if owner is None or field is None:
        return lower_opaque(context, node)
    if any(child.type == ".*" for child in node.children):
        method = ir.Name(*qualified_name(context, field))
        return ir.Call(_BIND, (method, lower_expression(context, owner)), (), line_of(node))
    return ir.Attr(lower_expression(context, owner), *qualified_name(context, field))


@lowers_expression("subscript_expression")
def _element(context: LoweringContext, node: Node) -> ir.Expr:
    owner = node.child_by_field_name("argument")
    indices = node.child_by_field_name("indices")
    if owner is None or indices is None:
        return lower_opaque(context, node)
    keys = lower_expressions(context, indices.named_children)
    key = keys[0] if len(keys) == 1 else ir.SequenceExpr(keys, "tuple")
    return ir.Index(lower_expression(context, owner), key)


@lowers_expression("call_expression")
def _call(context: LoweringContext, node: Node) -> ir.Expr:
    function = node.child_by_field_name("function")
    if function is None:
        return lower_opaque(context, node)
    context.note_call(function)
    args = lower_arguments(context, node.child_by_field_name("arguments"))
    if len(args) == 1 and _cast_name(context, node) in _CASTS:
        return args[0]
    addresses = _addresses(context, node.child_by_field_name("arguments"))
    return ir.Call(lower_expression(context, function), args, (), line_of(node), addresses)


def _addresses(context: LoweringContext, arguments: Node | None) -> tuple[int, ...]:
    """Return the positions of the arguments that are `&x`, or a cast of it."""
    given = arguments.named_children[:_MAX_ITEMS] if arguments else []
    return tuple(at for at, node in enumerate(given) if _is_address(context, node))


def _is_address(context: LoweringContext, node: Node | None) -> bool:
    if node is None:
        return False
    if node.type == "pointer_expression":
        return node.children[0].type == "&" and node.children[-1].type != "qualified_identifier"
    if node.type == "cast_expression":
        return _is_address(context, node.child_by_field_name("value"))
    if node.type == "call_expression" and _cast_name(context, node) in _CASTS:
        given = node.child_by_field_name("arguments")
        return given is not None and any(_is_address(context, one) for one in given.named_children)
    return False


def _cast_name(context: LoweringContext, node: Node) -> str:
    """Return `static_cast` of `static_cast<T>(x)`, empty for what is no call of a template."""
    function = node.child_by_field_name("function")
    if function is None or function.type != "template_function":
        return ""
    name = function.child_by_field_name("name")
    return context.text(name) if name is not None else ""


def lower_arguments(context: LoweringContext, node: Node | None) -> tuple[ir.Expr, ...]:
    """Return the expressions of an argument or initialiser list."""
    if node is None:
        return ()
    if node.type in {"argument_list", "initializer_list"}:
        children = node.named_children[:_MAX_ITEMS]
        if children and all(_designated_member(child) is not None for child in children):
            return (_designated_members(context, children),)
        return lower_expressions(context, children)
    return (lower_expression(context, node),)


@lowers_expression("initializer_list")
def _list(context: LoweringContext, node: Node) -> ir.Expr:
    args = lower_arguments(context, node)
    return (
        args[0]
        if args and isinstance(args[0], ir.MappingExpr)
        else ir.SequenceExpr(args, ir.BRACES)
    )


@lowers_expression("initializer_pair")
def _designated_initialiser(context: LoweringContext, node: Node) -> ir.Expr:
    value = node.child_by_field_name("value")
    return lower_expression(context, value) if value else lower_opaque(context, node)


def _designated_member(node: Node) -> Node | None:
    """Return the member that `.x = …` in braces names."""
    designator = node.child_by_field_name("designator")
    is_member = designator is not None and designator.type == "field_designator"
    return designator.named_children[0] if designator is not None and is_member else None


def _designated_members(context: LoweringContext, nodes: list[Node]) -> ir.MappingExpr:
    names = [context.text(name) for name in map(_designated_member, nodes) if name is not None]
    values = [_designated_initialiser(context, node) for node in nodes]
    return ir.MappingExpr(tuple(zip(map(ir.Const, names), values, strict=True)))


@lowers_expression("compound_literal_expression")
def _literal(context: LoweringContext, node: Node) -> ir.Expr:
    type = type_of(context, node.child_by_field_name("type")) or ir.TypeRef("auto")
    args = lower_arguments(context, node.child_by_field_name("value"))
    return ir.New(type, args, line_of(node), braced=True)


@lowers_expression("new_expression")
def _new(context: LoweringContext, node: Node) -> ir.Expr:
    type = type_of(context, node.child_by_field_name("type")) or ir.TypeRef("auto")
    array = node.child_by_field_name("declarator")
    if array is not None:
        length = array.child_by_field_name("length")
        type = ir.TypeRef("array", (type, ir.TypeRef(context.text(length)[:60] if length else "")))
    given = node.child_by_field_name("arguments")
    braced = given is not None and given.type == "initializer_list"
    return ir.New(type, lower_arguments(context, given), line_of(node), braced)


@lowers_expression("parameter_pack_expansion")
def _pack(context: LoweringContext, node: Node) -> ir.Expr:
    pattern = node.child_by_field_name("pattern")
    return ir.Star(_expansion(context, pattern)) if pattern else lower_opaque(context, node)


@lowers_expression("fold_expression")
def _fold(context: LoweringContext, node: Node) -> ir.Expr:
    """`(f(args), ...)`: what is folded is evaluated for each item of the packs in it."""
    operands = (_expansion(context, child) for child in node.named_children)
    return ir.Opaque(tuple(operands), context.text(node)[:60])


def _expansion(context: LoweringContext, node: Node) -> ir.Expr:
    """Return a pattern with the packs in it; nothing of it goes before the statement."""
    outer, context.statements = context.statements, None
    value = lower_expression(context, node)
    context.statements = outer
    found = dict.fromkeys(name for name in identifiers(context, node) if name in context.packs)
    return ir.Expansion(value, tuple(found)) if found and not isinstance(value, ir.Name) else value


def identifiers(context: LoweringContext, node: Node | None) -> Iterator[str]:
    """Yield the identifiers within a node."""
    left = [node] if node else []
    while left:
        child = left.pop()
        left.extend(child.named_children)
        if child.type == "identifier":
            yield context.text(child)


@lowers_expression("sizeof_expression", "alignof_expression", "offsetof_expression")
def _unknown(context: LoweringContext, node: Node) -> ir.Expr:
    return ir.Opaque((), context.text(node)[:60])

"""Variables and data members: their types and what they begin with."""

from collections.abc import Iterator
from dataclasses import dataclass

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.expressions import lower_arguments
from rtron.sources.code.frontends.cpp.lowering_context import (
    LoweringContext,
    line_of,
    lower_expression,
)
from rtron.sources.code.frontends.cpp.types import (
    Declarator,
    fields_of,
    has_specifier,
    is_constant,
    qualified_name,
    read_declarator,
    type_of,
)

_BUILT_IN = {"primitive_type", "sized_type_specifier", "placeholder_type_specifier"}
_EXPRESSIVE = {None, "abstract_function_declarator", "abstract_array_declarator"}


@dataclass(slots=True)
class NamedDeclarator:
    """One name of a declaration: its node, declarator and, behind it, its initialiser."""

    node: Node
    declarator: Declarator


def named_declarators(node: Node) -> Iterator[NamedDeclarator]:
    """Yield the names of a declaration (`int a = 1, *b;` has two)."""
    last: NamedDeclarator | None = None
    for field, child in fields_of(node):
        if field == "declarator":
            if last:
                yield last
            last = NamedDeclarator(child, read_declarator(child))
        elif field in {"value", "default_value"} and last:
            last.declarator.value = child
    if last:
        yield last


def lower_variable(
    context: LoweringContext, node: Node, one: NamedDeclarator, name: str
) -> ir.Declare:
    """Return the variable that a declaration declares under a name."""
    found = one.declarator
    element = type_of(context, node.child_by_field_name("type"))
    type = found.array_type(context, element)
    return ir.Declare(
        name,
        type,
        _initial(context, found, type),
        reference=found.reference,
        pointer=found.pointer,
        static=has_specifier(context, node, "storage_class_specifier", b"static"),
        line=line_of(one.node),
        constant=is_constant(context, node, found),
    )


def lower_local(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower a declaration in a function, where `Foo foo(bar);` is a variable."""
    for one in named_declarators(node):
        name = one.declarator.name
        if name is None:
            continue
        if name.type == "structured_binding_declarator":
            out.append(_lower_structured_binding(context, one))
        elif one.declarator.function is None:
            out.append(lower_variable(context, node, one, qualified_name(context, name)[0]))
        elif value := _vexing_arguments(context, node, one.declarator):
            _add_vexing(context, node, one, value, out)


def structured_binding(context: LoweringContext, node: Node) -> ir.SequenceExpr:
    """Return the names of a structured binding, `[a, b]`."""
    return ir.SequenceExpr(
        tuple(ir.Name(context.text(child)) for child in node.named_children), "tuple"
    )


def _lower_structured_binding(context: LoweringContext, one: NamedDeclarator) -> ir.Stmt:
    names, value = one.declarator.name, one.declarator.value
    target: ir.Expr = structured_binding(context, names) if names else ir.SequenceExpr(())
    args = lower_arguments(context, value)
    return ir.Assign((target,), args[0] if args else ir.Const(None), line_of(one.node))


def _initial(
    context: LoweringContext, found: Declarator, type: ir.TypeRef | None
) -> ir.Expr | None:
    value = found.value
    if value is None:
        return None
    braced = value.type == "initializer_list"
    if not braced and value.type != "argument_list":
        return lower_expression(context, value)
    if braced and (found.sizes or _is_assigned(context, value)):
        return lower_expression(context, value)
    args = lower_arguments(context, value)
    return _initialiser_value(found, type, args, line_of(value), braced=braced)


def _initialiser_value(
    found: Declarator,
    type: ir.TypeRef | None,
    args: tuple[ir.Expr, ...],
    line: int,
    *,
    braced: bool,
) -> ir.Expr:
    """Return what `T x(args)` begins with: a new T, or the argument where T makes nothing."""
    if type is None or found.pointer or found.reference:
        return args[0] if args else ir.Const(None)
    return ir.New(type, args, line, braced)


def _is_assigned(context: LoweringContext, value: Node) -> bool:
    before = context.source[max(value.start_byte - 40, 0) : value.start_byte]
    return before.rstrip().endswith(b"=")


def _add_vexing(
    context: LoweringContext,
    node: Node,
    one: NamedDeclarator,
    args: tuple[ir.Expr, ...],
    out: list[ir.Stmt],
) -> None:
    made = lower_variable(context, node, one, qualified_name(context, one.declarator.name)[0])
    value = _initialiser_value(one.declarator, made.type, args, made.line, braced=False)
    out.append(
        ir.Declare(
            made.name, made.type, value, made.reference, made.pointer, made.static, made.line
        )
    )


def _vexing_arguments(
    context: LoweringContext, node: Node, found: Declarator
) -> tuple[ir.Expr, ...] | None:
    """Return the arguments where a function's parameters are expressions in truth."""
    type = node.child_by_field_name("type")
    if found.function is None or type is None or context.text(type) == "void":
        return None
    return _read_as_arguments(context, found.function)


def _read_as_arguments(context: LoweringContext, function: Node) -> tuple[ir.Expr, ...] | None:
    parameters = function.child_by_field_name("parameters")
    args = [_argument(context, child) for child in parameters.named_children] if parameters else []
    expressions = tuple(arg for arg in args if arg is not None)
    return expressions if len(expressions) == len(args) else None


def _argument(context: LoweringContext, node: Node) -> ir.Expr | None:
    """Return the expression that reads like a parameter without a name, None if it has one."""
    children = node.named_children
    type, inner = node.child_by_field_name("type"), node.child_by_field_name("declarator")
    bare = len(children) == 1 + bool(inner) and node.type == "parameter_declaration"
    if type is None or not bare or type.type in _BUILT_IN or context.is_too_deep(node):
        return None
    value = ir.Name(*qualified_name(context, type))
    context.note_call(type)
    if inner is None:
        return value
    return _apply_declarator(context, value, inner) if inner.type in _EXPRESSIVE else None


def _apply_declarator(context: LoweringContext, value: ir.Name, inner: Node) -> ir.Expr | None:
    context.depth += 1
    applied: ir.Expr | None = None
    if inner.child_by_field_name("declarator") is None:
        if inner.type == "abstract_array_declarator":
            size = inner.child_by_field_name("size")
            applied = ir.Index(value, lower_expression(context, size)) if size else None
        else:
            args = _read_as_arguments(context, inner)
            applied = None if args is None else ir.Call(value, args, (), line_of(inner))
    context.depth -= 1
    return applied

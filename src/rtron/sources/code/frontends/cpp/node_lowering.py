"""Which function lowers which kind of node: one table for expressions, statements, declarations."""

from collections.abc import Callable, Iterable
from typing import TypeVar

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext, line_of

ExpressionLowerer = Callable[[LoweringContext, Node], ir.Expr]
StatementLowerer = Callable[[LoweringContext, Node, list[ir.Stmt]], None]
_Lowerer = TypeVar("_Lowerer")

_EXPRESSIONS: dict[str, ExpressionLowerer] = {}
_STATEMENTS: dict[str, StatementLowerer] = {}
_DECLARATIONS: dict[str, StatementLowerer] = {}
_MAX_PARTS = 4096


def _registering(
    table: dict[str, _Lowerer], kinds: tuple[str, ...]
) -> Callable[[_Lowerer], _Lowerer]:
    def register(function: _Lowerer) -> _Lowerer:
        table.update(dict.fromkeys(kinds, function))
        return function

    return register


def lowers_expression(*kinds: str) -> Callable[[ExpressionLowerer], ExpressionLowerer]:
    """Let a function lower expressions of these kinds."""
    return _registering(_EXPRESSIONS, kinds)


def lowers_statement(*kinds: str) -> Callable[[StatementLowerer], StatementLowerer]:
    """Let a function lower statements of these kinds, in a function's body."""
    return _registering(_STATEMENTS, kinds)


def lowers_declaration(*kinds: str) -> Callable[[StatementLowerer], StatementLowerer]:
    """Let a function lower these kinds of a namespace's or class's members."""
    return _registering(_DECLARATIONS, kinds)


def lower_expression(context: LoweringContext, node: Node) -> ir.Expr:
    """Return the lowered expression, an Opaque of what lies within where none lowers it."""
    if context.is_too_deep(node):
        return ir.Opaque((), context.text(node)[:60])
    context.depth += 1
    value = _EXPRESSIONS.get(node.type, lower_opaque)(context, node)
    context.depth -= 1
    return value


def lower_expressions(context: LoweringContext, nodes: Iterable[Node]) -> tuple[ir.Expr, ...]:
    """Return the lowered expressions."""
    return tuple([lower_expression(context, node) for node in nodes])


def lower_opaque(context: LoweringContext, node: Node) -> ir.Opaque:
    """Return an Opaque with the expressions within a node."""
    return ir.Opaque(
        lower_expressions(context, node.named_children[:_MAX_PARTS]), context.text(node)[:60]
    )


def lower_statement(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower a statement of a function into `out`; an ERROR node gives what can be read in it."""
    if context.is_too_deep(node):
        return
    kind = node.type
    outer, context.statements = context.statements, out
    context.depth += 1
    write = _STATEMENTS.get(kind) or _DECLARATIONS.get(kind)
    if write:
        write(context, node, out)
    elif kind in _EXPRESSIONS:
        out.append(ir.Evaluate(lower_expression(context, node), line_of(node)))
    context.depth -= 1
    context.statements = outer


def lower_block(context: LoweringContext, nodes: Iterable[Node]) -> tuple[ir.Stmt, ...]:
    """Return the lowered statements."""
    out: list[ir.Stmt] = []
    for node in nodes:
        lower_statement(context, node, out)
    return tuple(out)


def lower_declaration(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower a member of a namespace or class; its variables go to `out`."""
    write = _DECLARATIONS.get(node.type)
    if write and not context.is_too_deep(node):
        outer, context.statements = context.statements, None
        context.depth += 1
        write(context, node, out)
        context.depth -= 1
        context.statements = outer

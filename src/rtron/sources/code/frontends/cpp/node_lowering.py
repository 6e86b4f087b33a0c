"""Which function lowers which kind of node: one table for expressions, statements, declarations."""

from collections.abc import Callable, Iterable

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.lowering_context import Context, line_of
from rtron.sources.code.ir import Evaluate, Expr, Opaque, Stmt

Lowerer = Callable[[Context, Node], Expr]
Writer = Callable[[Context, Node, list[Stmt]], None]

_EXPRESSIONS: dict[str, Lowerer] = {}
_STATEMENTS: dict[str, Writer] = {}
_DECLARATIONS: dict[str, Writer] = {}
_MAX_PARTS = 4096


def lowers(*kinds: str) -> Callable[[Lowerer], Lowerer]:
    """Let a function lower expressions of these kinds."""

    def register(function: Lowerer) -> Lowerer:
        _EXPRESSIONS.update(dict.fromkeys(kinds, function))
        return function

    return register


def states(*kinds: str) -> Callable[[Writer], Writer]:
    """Let a function lower statements of these kinds, in a function's body."""

    def register(function: Writer) -> Writer:
        _STATEMENTS.update(dict.fromkeys(kinds, function))
        return function

    return register


def declares(*kinds: str) -> Callable[[Writer], Writer]:
    """Let a function lower these kinds of a namespace's or class's members."""

    def register(function: Writer) -> Writer:
        _DECLARATIONS.update(dict.fromkeys(kinds, function))
        return function

    return register


def expression(context: Context, node: Node) -> Expr:
    """Return the lowered expression, an Opaque of what lies within where none lowers it."""
    if context.too_deep(node):
        return Opaque((), context.text(node)[:60])
    context.depth += 1
    lower = _EXPRESSIONS.get(node.type)
    value = lower(context, node) if lower else _opaque(context, node)
    context.depth -= 1
    return value


def expressions(context: Context, nodes: Iterable[Node]) -> tuple[Expr, ...]:
    """Return the lowered expressions."""
    return tuple([expression(context, node) for node in nodes])


def opaque(context: Context, node: Node) -> Opaque:
    """Return an Opaque with the expressions within a node."""
    return Opaque(expressions(context, node.named_children[:_MAX_PARTS]), context.text(node)[:60])


def _opaque(context: Context, node: Node) -> Expr:
    return opaque(context, node)


def statement(context: Context, node: Node, out: list[Stmt]) -> None:
    """Lower a statement of a function into `out`; an ERROR gives what is readable within it."""
    if context.too_deep(node):
        return
    kind = node.type
    outer, context.out = context.out, out
    context.depth += 1
    write = _STATEMENTS.get(kind) or _DECLARATIONS.get(kind)
    if write:
        write(context, node, out)
    elif kind in _EXPRESSIONS:
        out.append(Evaluate(expression(context, node), line_of(node)))
    context.depth -= 1
    context.out = outer


def block(context: Context, nodes: Iterable[Node]) -> tuple[Stmt, ...]:
    """Return the lowered statements."""
    out: list[Stmt] = []
    for node in nodes:
        statement(context, node, out)
    return tuple(out)


def declaration(context: Context, node: Node, out: list[Stmt]) -> None:
    """Lower a member of a namespace or class; its variables go to `out`."""
    write = _DECLARATIONS.get(node.type)
    if write and not context.too_deep(node):
        outer, context.out = context.out, None
        context.depth += 1
        write(context, node, out)
        context.depth -= 1
        context.out = outer

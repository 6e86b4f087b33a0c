"""Expressions of Python as expressions of the intermediate representation."""

import ast
from collections.abc import Iterable
from functools import singledispatch
from itertools import pairwise

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.operators import BINARY, COMPARE, UNARY
from rtron.sources.code.frontends.python.parameters import parameters
from rtron.sources.code.frontends.python.source_file import Source
from rtron.sources.code.ir import Expr

_PLAIN = (str, int, float, bytes, type(None))


def expression(node: ast.expr, source: Source) -> Expr:
    """Lower an expression; one that is nested too deep becomes an Opaque without parts."""
    if source.is_too_deep(node.lineno):
        return ir.Opaque((), source.snippet(node))
    source.depth += 1
    try:
        return _lowered(node, source)
    finally:
        source.depth -= 1


def expressions(nodes: Iterable[ast.expr], source: Source) -> tuple[Expr, ...]:
    """Lower expressions in their order."""
    return tuple([expression(node, source) for node in nodes])


def optional(node: ast.expr | None, source: Source) -> Expr | None:
    """Lower an expression that may be absent."""
    return expression(node, source) if node else None


def opaque(node: ast.expr, parts: Iterable[ast.expr], source: Source) -> ir.Opaque:
    """Keep the parts of an expression which has no counterpart, and its text."""
    return ir.Opaque(expressions(parts, source), source.snippet(node))


def _unsure(nodes: Iterable[ast.expr], source: Source) -> tuple[Expr, ...]:
    with source.unsure():
        return expressions(nodes, source)


@singledispatch
def _lowered(node: ast.expr, source: Source) -> Expr:
    """Whatever a newer Python may add."""
    parts = [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]
    return opaque(node, parts, source)


@_lowered.register
def _(node: ast.Name, _: Source) -> Expr:
    return ir.Name(node.id)


@_lowered.register
def _(node: ast.Constant, source: Source) -> Expr:
    return ir.Const(node.value) if isinstance(node.value, _PLAIN) else opaque(node, (), source)


@_lowered.register
def _(node: ast.Attribute, source: Source) -> Expr:
    return ir.Attr(expression(node.value, source), node.attr)


@_lowered.register
def _(node: ast.Subscript, source: Source) -> Expr:
    return ir.Index(expression(node.value, source), expression(node.slice, source))


@_lowered.register
def _(node: ast.Slice, source: Source) -> Expr:
    bounds = [optional(part, source) for part in (node.lower, node.upper, node.step)]
    return ir.Call(
        ir.Name("slice"), tuple(part or ir.Const(None) for part in bounds), line=node.lineno
    )


@_lowered.register
def _(node: ast.Call, source: Source) -> Expr:
    function = expression(node.func, source)
    args = expressions(node.args, source)
    keywords = [(word.arg or "**", expression(word.value, source)) for word in node.keywords]
    return ir.Call(function, args, tuple(keywords), node.lineno)


@_lowered.register
def _(node: ast.BinOp, source: Source) -> Expr:
    left, right = expression(node.left, source), expression(node.right, source)
    return ir.Binary(BINARY[type(node.op)], left, right, node.lineno)


@_lowered.register
def _(node: ast.UnaryOp, source: Source) -> Expr:
    return ir.Unary(UNARY[type(node.op)], expression(node.operand, source))


@_lowered.register
def _(node: ast.BoolOp, source: Source) -> Expr:
    first, *others = node.values
    operands = (expression(first, source), *_unsure(others, source))
    return ir.Logic("and" if isinstance(node.op, ast.And) else "or", operands)


@_lowered.register
def _(node: ast.Compare, source: Source) -> Expr:
    """Lower `a < b < c` as `a < b and b < c`."""
    operands = (*expressions([node.left, node.comparators[0]], source),)
    operands += _unsure(node.comparators[1:], source)
    steps = tuple(
        ir.Binary(COMPARE[type(operation)], left, right, node.lineno)
        for operation, (left, right) in zip(node.ops, pairwise(operands), strict=True)
    )
    return ir.Logic("and", steps) if len(steps) > 1 else steps[0]


@_lowered.register
def _(node: ast.IfExp, source: Source) -> Expr:
    test = expression(node.test, source)
    return ir.Conditional(test, *_unsure([node.body, node.orelse], source))


@_lowered.register
def _(node: ast.JoinedStr, source: Source) -> Expr:
    return ir.Concat(expressions(node.values, source))


@_lowered.register
def _(node: ast.FormattedValue, source: Source) -> Expr:
    """Lower a value; what `!r`, `!a` or a format make of it is not known."""
    if node.format_spec is None and node.conversion in (-1, ord("s")):
        return expression(node.value, source)
    spec = node.format_spec.values if isinstance(node.format_spec, ast.JoinedStr) else []
    return opaque(node, [node.value, *spec], source)


@_lowered.register
def _(node: ast.List, source: Source) -> Expr:
    return ir.Sequence(expressions(node.elts, source), "list")


@_lowered.register
def _(node: ast.Tuple, source: Source) -> Expr:
    return ir.Sequence(expressions(node.elts, source), "tuple")


@_lowered.register
def _(node: ast.Set, source: Source) -> Expr:
    return ir.Sequence(expressions(node.elts, source), "set")


@_lowered.register
def _(node: ast.Dict, source: Source) -> Expr:
    pairs = zip(node.keys, node.values, strict=True)
    return ir.Mapping(
        tuple([(optional(key, source), expression(value, source)) for key, value in pairs])
    )


@_lowered.register
def _(node: ast.ListComp, source: Source) -> Expr:
    return _comprehension("list", node.elt, node.generators, source)


@_lowered.register
def _(node: ast.SetComp, source: Source) -> Expr:
    return _comprehension("set", node.elt, node.generators, source)


@_lowered.register
def _(node: ast.GeneratorExp, source: Source) -> Expr:
    return _comprehension("generator", node.elt, node.generators, source)


@_lowered.register
def _(node: ast.DictComp, source: Source) -> Expr:
    pair = ast.copy_location(ast.Tuple([node.key, node.value], ast.Load()), node)
    return _comprehension("dict", pair, node.generators, source)


def _comprehension(
    kind: str, element: ast.expr, loops: list[ast.comprehension], source: Source
) -> Expr:
    with source.unsure():
        lowered = [
            (
                expression(loop.target, source),
                expression(loop.iter, source),
                expressions(loop.ifs, source),
            )
            for loop in loops
        ]
        return ir.Comprehension(kind, expression(element, source), tuple(lowered))


@_lowered.register
def _(node: ast.Lambda, source: Source) -> Expr:
    with source.unsure():
        params = parameters(node.args, lambda default: optional(default, source))
        body = (ir.Return(expression(node.body, source), node.lineno),)
    return ir.Lambda(
        ir.Function(name="<lambda>", file=source.file, line=node.lineno, params=params, body=body)
    )


@_lowered.register
def _(node: ast.Starred, source: Source) -> Expr:
    return ir.Star(expression(node.value, source))


@_lowered.register
def _(node: ast.Await, source: Source) -> Expr:
    """Take what a coroutine returns for what the call of its function returns."""
    return expression(node.value, source)


@_lowered.register
def _(node: ast.NamedExpr, source: Source) -> Expr:
    if not source.sure:
        return opaque(node, [node.value], source)
    target, value = expression(node.target, source), expression(node.value, source)
    source.before.append(ir.Assign((target,), value, node.lineno))
    return target


@_lowered.register
def _(node: ast.Yield, source: Source) -> Expr:
    return _sent(node, optional(node.value, source), source)


@_lowered.register
def _(node: ast.YieldFrom, source: Source) -> Expr:
    return _sent(node, ir.Star(expression(node.value, source)), source)


def _sent(node: ast.expr, value: Expr | None, source: Source) -> Expr:
    """Put a `yield` before its statement; what it gives back is not known."""
    source.before.append(ir.Yield(value))
    return ir.Opaque((), source.snippet(node))

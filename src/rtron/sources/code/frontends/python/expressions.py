"""Expressions of Python as expressions of the intermediate representation."""

import ast
from collections.abc import Iterable
from functools import singledispatch
from itertools import pairwise
from typing import Final

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.parameters import lower_parameters
from rtron.sources.code.frontends.python.source_file import SourceFile
from rtron.sources.code.ir import Expr

_CONSTANT_TYPES = (str, int, float, bytes, type(None))


def lower_expression(node: ast.expr, source: SourceFile) -> Expr:
    """Lower an expression; one that is nested too deep becomes an Opaque without parts."""
    if source.is_too_deep(node.lineno):
        return ir.Opaque((), source.snippet(node))
    source.depth += 1
    try:
        return _lower(node, source)
    finally:
        source.depth -= 1


def lower_expressions(nodes: Iterable[ast.expr], source: SourceFile) -> tuple[Expr, ...]:
    """Lower expressions in their order."""
    return tuple([lower_expression(node, source) for node in nodes])


def lower_optional(node: ast.expr | None, source: SourceFile) -> Expr | None:
    """Lower an expression that may be absent."""
    return lower_expression(node, source) if node else None


def lower_opaque(node: ast.expr, parts: Iterable[ast.expr], source: SourceFile) -> ir.Opaque:
    """Keep the parts of an expression which has no counterpart, and its text."""
    return ir.Opaque(lower_expressions(parts, source), source.snippet(node))


@singledispatch
def _lower(node: ast.expr, source: SourceFile) -> Expr:
    """Whatever a newer Python may add."""
    parts = [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]
    return lower_opaque(node, parts, source)


@_lower.register
def _(node: ast.Name, source: SourceFile) -> Expr:
    return ir.Name(source.own_name(node.id))


@_lower.register
def _(node: ast.Constant, source: SourceFile) -> Expr:
    if isinstance(node.value, _CONSTANT_TYPES):
        return ir.Const(node.value)
    return lower_opaque(node, (), source)


@_lower.register
def _(node: ast.Attribute, source: SourceFile) -> Expr:
    return ir.Attr(lower_expression(node.value, source), source.own_name(node.attr))


@_lower.register
def _(node: ast.Subscript, source: SourceFile) -> Expr:
    return ir.Index(lower_expression(node.value, source), lower_expression(node.slice, source))


@_lower.register
def _(node: ast.Slice, source: SourceFile) -> Expr:
    bounds = [lower_optional(part, source) for part in (node.lower, node.upper, node.step)]
    return ir.Call(
        ir.Name("slice"), tuple(part or ir.Const(None) for part in bounds), line=node.lineno
    )


@_lower.register
def _(node: ast.Call, source: SourceFile) -> Expr:
    function = lower_expression(node.func, source)
    args = lower_expressions(node.args, source)
    keywords = [(word.arg or "**", lower_expression(word.value, source)) for word in node.keywords]
    return ir.Call(function, args, tuple(keywords), node.lineno)


@_lower.register
def _(node: ast.BinOp, source: SourceFile) -> Expr:
    left, right = lower_expression(node.left, source), lower_expression(node.right, source)
    return ir.Binary(BINARY[type(node.op)], left, right, node.lineno)


@_lower.register
def _(node: ast.UnaryOp, source: SourceFile) -> Expr:
    return ir.Unary(UNARY[type(node.op)], lower_expression(node.operand, source))


@_lower.register
def _(node: ast.BoolOp, source: SourceFile) -> Expr:
    operator = "and" if isinstance(node.op, ast.And) else "or"
    return ir.Logic(operator, lower_expressions(node.values, source))


@_lower.register
def _(node: ast.Compare, source: SourceFile) -> Expr:
    """Lower `a < b < c` as `a < b and b < c`."""
    operands = lower_expressions([node.left, *node.comparators], source)
    steps = tuple(
        ir.Binary(COMPARE[type(operation)], left, right, node.lineno)
        for operation, (left, right) in zip(node.ops, pairwise(operands), strict=True)
    )
    return ir.Logic("and", steps) if len(steps) > 1 else steps[0]


@_lower.register
def _(node: ast.IfExp, source: SourceFile) -> Expr:
    test = lower_expression(node.test, source)
    return ir.Conditional(test, *lower_expressions([node.body, node.orelse], source))


@_lower.register
def _(node: ast.JoinedStr, source: SourceFile) -> Expr:
    return ir.Concat(lower_expressions(node.values, source))


@_lower.register
def _(node: ast.FormattedValue, source: SourceFile) -> Expr:
    """Lower a value; under a format it is `"{:…}".format(value, …)`."""
    spec = node.format_spec.values if isinstance(node.format_spec, ast.JoinedStr) else []
    if not spec and node.conversion in (-1, ord("s")):
        return lower_expression(node.value, source)
    conversion = f"!{chr(node.conversion)}" if node.conversion != -1 else ""
    written = [str(part.value) if isinstance(part, ast.Constant) else "{}" for part in spec]
    template = ir.Attr(ir.Const(f"{{{conversion}:{''.join(written)}}}"), "format")
    inner = (part for part in spec if not isinstance(part, ast.Constant))
    args = lower_expressions([node.value, *inner], source)
    return ir.Call(template, args, line=node.lineno)


@_lower.register
def _(node: ast.List, source: SourceFile) -> Expr:
    return ir.SequenceExpr(lower_expressions(node.elts, source), "list")


@_lower.register
def _(node: ast.Tuple, source: SourceFile) -> Expr:
    return ir.SequenceExpr(lower_expressions(node.elts, source), "tuple")


@_lower.register
def _(node: ast.Set, source: SourceFile) -> Expr:
    return ir.SequenceExpr(lower_expressions(node.elts, source), "set")


@_lower.register
def _(node: ast.Dict, source: SourceFile) -> Expr:
    pairs = zip(node.keys, node.values, strict=True)
    return ir.MappingExpr(
        tuple(
            [(lower_optional(key, source), lower_expression(value, source)) for key, value in pairs]
        )
    )


@_lower.register
def _(node: ast.ListComp, source: SourceFile) -> Expr:
    return _comprehension("list", node.elt, node.generators, source)


@_lower.register
def _(node: ast.SetComp, source: SourceFile) -> Expr:
    return _comprehension("set", node.elt, node.generators, source)


@_lower.register
def _(node: ast.GeneratorExp, source: SourceFile) -> Expr:
    return _comprehension("generator", node.elt, node.generators, source)


@_lower.register
def _(node: ast.DictComp, source: SourceFile) -> Expr:
    pair = ast.copy_location(ast.Tuple([node.key, node.value], ast.Load()), node)
    return _comprehension("dict", pair, node.generators, source)


def _comprehension(
    kind: str, element: ast.expr, loops: list[ast.comprehension], source: SourceFile
) -> Expr:
    lowered = [
        (
            lower_expression(loop.target, source),
            lower_expression(loop.iter, source),
            lower_expressions(loop.ifs, source),
        )
        for loop in loops
    ]
    return ir.Comprehension(kind, lower_expression(element, source), tuple(lowered))


@_lower.register
def _(node: ast.Lambda, source: SourceFile) -> Expr:
    params = lower_parameters(
        node.args, lambda default: lower_optional(default, source), source.own_name
    )
    body = (ir.Return(lower_expression(node.body, source), node.lineno),)
    return ir.Lambda(
        ir.Function(
            name=source.lambda_name(node.lineno),
            file=source.file,
            line=node.lineno,
            params=params,
            body=body,
        )
    )


@_lower.register
def _(node: ast.Starred, source: SourceFile) -> Expr:
    return ir.Star(lower_expression(node.value, source))


@_lower.register
def _(node: ast.Await, source: SourceFile) -> Expr:
    """Take what a coroutine returns for what the call of its function returns."""
    return lower_expression(node.value, source)


@_lower.register
def _(node: ast.NamedExpr, source: SourceFile) -> Expr:
    target, value = lower_expression(node.target, source), lower_expression(node.value, source)
    return ir.AssignExpr(target, value)


@_lower.register
def _(node: ast.Yield, source: SourceFile) -> Expr:
    return _lower_yield(node, lower_optional(node.value, source), source)


@_lower.register
def _(node: ast.YieldFrom, source: SourceFile) -> Expr:
    return _lower_yield(node, ir.Star(lower_expression(node.value, source)), source)


def _lower_yield(node: ast.expr, value: Expr | None, source: SourceFile) -> Expr:
    """Put a `yield` before its statement; what it gives back is not known."""
    source.preceding.append(ir.Yield(value))
    return ir.Opaque((), source.snippet(node))


BINARY: Final[dict[type[ast.operator], str]] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.MatMult: "@",
    ast.LShift: "<<",
    ast.RShift: ">>",
    ast.BitAnd: "&",
    ast.BitOr: "|",
    ast.BitXor: "^",
}
IN_PLACE: Final = frozenset({"+", "|"})
"""Those that change a list, a set or a dict itself under an augmented assignment, `a += b`."""
UNARY: Final[dict[type[ast.unaryop], str]] = {
    ast.Not: "not",
    ast.USub: "-",
    ast.UAdd: "+",
    ast.Invert: "~",
}
COMPARE: Final[dict[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Is: "is",
    ast.IsNot: "is not",
    ast.In: "in",
    ast.NotIn: "not in",
}

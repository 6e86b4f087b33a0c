"""Parameters of a function and their annotations."""

import ast
from collections.abc import Callable, Iterator
from dataclasses import replace

from rtron.sources.code import ir

_MAX_DEPTH = 20


def lower_parameters(
    node: ast.arguments,
    lowered: Callable[[ast.expr | None], ir.Expr | None],
    own_name: Callable[[str], str],
) -> tuple[ir.Param, ...]:
    """Return the parameters in the order in which they are written."""
    return tuple(replace(param, name=own_name(param.name)) for param in _parameters(node, lowered))


def dotted_name(node: ast.expr | None) -> str:
    """Return the name `a.b.c` that an expression is, else an empty string."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    return ".".join(reversed([*parts, node.id])) if isinstance(node, ast.Name) else ""


def annotation_type(node: ast.expr | None, depth: int = 0) -> ir.TypeRef | None:
    """Return an annotation that names a type: `a.B`, `"B"`, `List[a.B]`; else None."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return ir.TypeRef(node.value)
    if isinstance(node, ast.Subscript) and depth < _MAX_DEPTH:
        items = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        args = tuple(found for item in items if (found := annotation_type(item, depth + 1)))
        return ir.TypeRef(name, args) if (name := dotted_name(node.value)) else None
    return ir.TypeRef(name) if (name := dotted_name(node)) else None


def _parameters(
    node: ast.arguments, lowered: Callable[[ast.expr | None], ir.Expr | None]
) -> Iterator[ir.Param]:
    plain = [*node.posonlyargs, *node.args]
    missing: list[ast.expr | None] = [None] * (len(plain) - len(node.defaults))
    for arg, default in zip(plain, [*missing, *node.defaults], strict=True):
        yield ir.Param(arg.arg, annotation_type(arg.annotation), lowered(default))
    if node.vararg:
        yield ir.Param(node.vararg.arg, annotation_type(node.vararg.annotation), kind="star")
    for arg, default in zip(node.kwonlyargs, node.kw_defaults, strict=True):
        yield ir.Param(arg.arg, annotation_type(arg.annotation), lowered(default), kind="keyword")
    if node.kwarg:
        yield ir.Param(node.kwarg.arg, annotation_type(node.kwarg.annotation), kind="stars")

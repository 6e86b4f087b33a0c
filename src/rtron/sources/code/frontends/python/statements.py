"""Statements of Python as statements of the intermediate representation."""

import ast
from collections.abc import Iterable
from functools import singledispatch

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.expressions import (
    BINARY,
    IN_PLACE,
    lower_expression,
    lower_expressions,
    lower_optional,
)
from rtron.sources.code.frontends.python.match_statement import lower_match
from rtron.sources.code.frontends.python.parameters import (
    annotation_type,
    dotted_name,
    lower_parameters,
)
from rtron.sources.code.frontends.python.python2_syntax import TUPLE_PARAMETER
from rtron.sources.code.frontends.python.source_file import SourceFile

_Stmts = tuple[ir.Stmt, ...]


def lower_statements(nodes: Iterable[ast.stmt], source: SourceFile) -> _Stmts:
    """Lower statements in their order; docstrings and `pass` vanish."""
    return tuple([stmt for node in nodes for stmt in _lower_statement(node, source)])


def _lower_statement(node: ast.stmt, source: SourceFile) -> _Stmts:
    if source.is_too_deep(node.lineno):
        return ()
    outer, source.preceding = source.preceding, []
    source.depth += 1
    try:
        lowered = _lower(node, source)
        return (*source.preceding, *lowered)
    finally:
        source.depth -= 1
        source.preceding = outer


@singledispatch
def _lower(node: ast.stmt, source: SourceFile) -> _Stmts:
    """`pass`, and whatever a newer Python may add: its expressions are evaluated."""
    parts = [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]
    return tuple(ir.Evaluate(lower_expression(part, source), node.lineno) for part in parts)


@_lower.register
def _(node: ast.Expr, source: SourceFile) -> _Stmts:
    if isinstance(node.value, ast.Constant):
        return ()
    value = lower_expression(node.value, source)
    if isinstance(node.value, ast.Yield | ast.YieldFrom):
        return ()
    return (ir.Evaluate(value, node.lineno),)


@_lower.register
def _(node: ast.Assign, source: SourceFile) -> _Stmts:
    value = lower_expression(node.value, source)
    return (ir.Assign(lower_expressions(node.targets, source), value, node.lineno),)


@_lower.register
def _(node: ast.AnnAssign, source: SourceFile) -> _Stmts:
    if node.value is None:
        return ()
    value = lower_expression(node.value, source)
    return (ir.Assign((lower_expression(node.target, source),), value, node.lineno),)


@_lower.register
def _(node: ast.AugAssign, source: SourceFile) -> _Stmts:
    target = lower_expression(node.target, source)
    operator, right = BINARY[type(node.op)], lower_expression(node.value, source)
    operator += "=" if operator in IN_PLACE else ""
    return (ir.Assign((target,), ir.Binary(operator, target, right, node.lineno), node.lineno),)


@_lower.register
def _(node: ast.If, source: SourceFile) -> _Stmts:
    test = lower_expression(node.test, source)
    body, orelse = lower_statements(node.body, source), lower_statements(node.orelse, source)
    return (ir.If(test, body, orelse, node.lineno),)


@_lower.register
def _(node: ast.While, source: SourceFile) -> _Stmts:
    test = lower_expression(node.test, source)
    body, orelse = lower_statements(node.body, source), lower_statements(node.orelse, source)
    return (ir.While(test, body, tuple(source.preceding), line=node.lineno, orelse=orelse),)


@_lower.register(ast.For)
@_lower.register(ast.AsyncFor)
def _(node: ast.For | ast.AsyncFor, source: SourceFile) -> _Stmts:
    iterable = lower_expression(node.iter, source)
    target = lower_expression(node.target, source)
    body, orelse = lower_statements(node.body, source), lower_statements(node.orelse, source)
    return (ir.ForEach(target, iterable, body, node.lineno, orelse),)


@_lower.register(ast.With)
@_lower.register(ast.AsyncWith)
def _(node: ast.With | ast.AsyncWith, source: SourceFile) -> _Stmts:
    """Lower `with a, b` as `with a: with b`."""
    body = lower_statements(node.body, source)
    for item in reversed(node.items):
        manager = lower_expression(item.context_expr, source)
        target = lower_optional(item.optional_vars, source)
        body = (ir.With(manager, target, body, item.context_expr.lineno),)
    return body


@_lower.register(ast.Try)
@_lower.register(getattr(ast, "TryStar", ast.Try))
def _(node: ast.Try, source: SourceFile) -> _Stmts:
    return (
        ir.Try(
            lower_statements(node.body, source),
            tuple([_handler(handler, source) for handler in node.handlers]),
            lower_statements(node.orelse, source),
            lower_statements(node.finalbody, source),
        ),
    )


def _handler(node: ast.ExceptHandler, source: SourceFile) -> tuple[tuple[str, ...], str, _Stmts]:
    caught = node.type.elts if isinstance(node.type, ast.Tuple) else [node.type]
    names = tuple(dotted_name(kind) for kind in caught if kind)
    return names, node.name or "", lower_statements(node.body, source)


@_lower.register
def _(node: ast.Match, source: SourceFile) -> _Stmts:
    return lower_match(node, source, lower_statements)


@_lower.register
def _(node: ast.Assert, source: SourceFile) -> _Stmts:
    test = lower_expression(node.test, source)
    args = lower_expressions([node.msg] if node.msg else [], source)
    raised = ir.Raise(ir.Call(ir.Name("AssertionError"), args, line=node.lineno))
    return (ir.If(ir.Unary("not", test), (raised,), (), node.lineno),)


@_lower.register
def _(node: ast.Return, source: SourceFile) -> _Stmts:
    return (ir.Return(lower_optional(node.value, source), node.lineno),)


@_lower.register
def _(node: ast.Raise, source: SourceFile) -> _Stmts:
    return (ir.Raise(lower_optional(node.exc, source)),)


@_lower.register
def _(_node: ast.Break, _: SourceFile) -> _Stmts:
    return (ir.Break(),)


@_lower.register
def _(_node: ast.Continue, _: SourceFile) -> _Stmts:
    return (ir.Continue(),)


@_lower.register
def _(node: ast.Delete, source: SourceFile) -> _Stmts:
    return (ir.Delete(lower_expressions(node.targets, source)),)


@_lower.register(ast.Global)
@_lower.register(ast.Nonlocal)
def _(node: ast.Global | ast.Nonlocal, _: SourceFile) -> _Stmts:
    return (ir.Global(tuple(node.names), module=isinstance(node, ast.Global)),)


@_lower.register
def _(node: ast.Import, _: SourceFile) -> _Stmts:
    return tuple(
        ir.Import(name.name, None, name.asname or "", line=node.lineno) for name in node.names
    )


@_lower.register
def _(node: ast.ImportFrom, _: SourceFile) -> _Stmts:
    return tuple(
        ir.Import(node.module or "", name.name, name.asname or name.name, node.level, node.lineno)
        for name in node.names
    )


@_lower.register(ast.FunctionDef)
@_lower.register(ast.AsyncFunctionDef)
def _(node: ast.FunctionDef | ast.AsyncFunctionDef, source: SourceFile) -> _Stmts:
    decorators = lower_expressions(node.decorator_list, source)
    function = ir.Function(
        name=source.own_name(node.name),
        file=source.file,
        line=node.lineno,
        params=lower_parameters(
            node.args, lambda default: lower_optional(default, source), source.own_name
        ),
        body=(*_unpack_tuple_parameters(node.args, source), *lower_statements(node.body, source)),
        returns=annotation_type(node.returns),
    )
    return (ir.Define(function, decorators),)


def _unpack_tuple_parameters(node: ast.arguments, source: SourceFile) -> _Stmts:
    """Python 2's parameters `(a, b)`, as `as_python3` wrote them."""
    return tuple(
        ir.Assign((lower_expression(arg.annotation, source),), ir.Name(arg.arg), arg.lineno)
        for arg in node.args
        if arg.arg.startswith(TUPLE_PARAMETER) and isinstance(arg.annotation, ast.Tuple)
    )


@_lower.register
def _(node: ast.ClassDef, source: SourceFile) -> _Stmts:
    decorators = lower_expressions(node.decorator_list, source)
    bases: tuple[ir.Expr, ...] = lower_expressions(node.bases, source)
    outer, source.class_name = source.class_name, node.name
    body = (*_annotated_fields(node), *lower_statements(node.body, source))
    source.class_name = outer
    keywords = [(word.arg or "**", lower_expression(word.value, source)) for word in node.keywords]
    made = ir.Class(
        name=source.own_name(node.name),
        file=source.file,
        line=node.lineno,
        bases=bases,
        body=body,
        keywords=tuple(keywords),
    )
    return (ir.Define(made, decorators),)


def _annotated_fields(node: ast.ClassDef) -> _Stmts:
    """Keep the names that a class annotates, for a dataclass or a NamedTuple, as `__fields__`."""
    annotated = [part for part in node.body if isinstance(part, ast.AnnAssign)]
    fields_only = [part for part in annotated if not _is_class_variable(part.annotation)]
    names = [ir.Const(part.target.id) for part in fields_only if isinstance(part.target, ast.Name)]
    if not names or not (node.decorator_list or node.bases):
        return ()
    fields = ir.SequenceExpr(tuple(names), "tuple")
    return (ir.Assign((ir.Name("__fields__"),), fields, node.lineno),)


def _is_class_variable(annotation: ast.expr) -> bool:
    head = annotation.value if isinstance(annotation, ast.Subscript) else annotation
    return dotted_name(head).rpartition(".")[2] == "ClassVar"

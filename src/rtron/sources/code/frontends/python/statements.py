"""Statements of Python as statements of the intermediate representation."""

import ast
from collections.abc import Iterable
from functools import singledispatch

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.expressions import expression, expressions, optional
from rtron.sources.code.frontends.python.match_statement import cases
from rtron.sources.code.frontends.python.operators import BINARY
from rtron.sources.code.frontends.python.parameters import dotted, parameters, type_of
from rtron.sources.code.frontends.python.python2_syntax import TUPLE_PARAMETER
from rtron.sources.code.frontends.python.source_file import Source
from rtron.sources.code.ir import Expr, Stmt

_Stmts = tuple[Stmt, ...]


def statements(nodes: Iterable[ast.stmt], source: Source) -> _Stmts:
    """Lower statements in their order; docstrings and `pass` vanish."""
    return tuple([stmt for node in nodes for stmt in _statement(node, source)])


def _statement(node: ast.stmt, source: Source) -> _Stmts:
    if source.is_too_deep(node.lineno):
        return ()
    outer, source.before = source.before, []
    source.depth += 1
    try:
        lowered = _lowered(node, source)
        return (*source.before, *lowered)
    finally:
        source.depth -= 1
        source.before = outer


@singledispatch
def _lowered(node: ast.stmt, source: Source) -> _Stmts:
    """`pass`, and whatever a newer Python may add: its expressions are evaluated."""
    parts = [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]
    return tuple(ir.Evaluate(expression(part, source), node.lineno) for part in parts)


@_lowered.register
def _(node: ast.Expr, source: Source) -> _Stmts:
    if isinstance(node.value, ast.Constant):
        return ()
    value = expression(node.value, source)
    if isinstance(node.value, ast.Yield | ast.YieldFrom):
        return ()
    return (ir.Evaluate(value, node.lineno),)


@_lowered.register
def _(node: ast.Assign, source: Source) -> _Stmts:
    value = expression(node.value, source)
    return (ir.Assign(expressions(node.targets, source), value, node.lineno),)


@_lowered.register
def _(node: ast.AnnAssign, source: Source) -> _Stmts:
    if node.value is None:
        return ()
    value = expression(node.value, source)
    return (ir.Assign((expression(node.target, source),), value, node.lineno),)


@_lowered.register
def _(node: ast.AugAssign, source: Source) -> _Stmts:
    target = expression(node.target, source)
    operator, right = BINARY[type(node.op)], expression(node.value, source)
    return (ir.Assign((target,), ir.Binary(operator, target, right, node.lineno), node.lineno),)


@_lowered.register
def _(node: ast.If, source: Source) -> _Stmts:
    test = expression(node.test, source)
    body, orelse = statements(node.body, source), statements(node.orelse, source)
    return (ir.If(test, body, orelse, node.lineno),)


@_lowered.register
def _(node: ast.While, source: Source) -> _Stmts:
    test = expression(node.test, source)
    again = tuple(source.before)
    loop = ir.While(test, statements(node.body, source), again, line=node.lineno)
    return (loop, *_behind_loop(node, source))


@_lowered.register(ast.For)
@_lowered.register(ast.AsyncFor)
def _(node: ast.For | ast.AsyncFor, source: Source) -> _Stmts:
    iterable = expression(node.iter, source)
    target = expression(node.target, source)
    loop = ir.ForEach(target, iterable, statements(node.body, source), node.lineno)
    return (loop, *_behind_loop(node, source))


def _behind_loop(node: ast.For | ast.AsyncFor | ast.While, source: Source) -> _Stmts:
    """Lower the `else` of a loop: it runs unless the loop was left by `break`."""
    orelse = statements(node.orelse, source)
    if not orelse or not _breaks(node.body):
        return orelse
    return (ir.If(ir.Opaque((), "no break"), orelse, (), node.lineno),)


def _breaks(body: list[ast.stmt]) -> bool:
    return any(isinstance(node, ast.Break) for statement in body for node in ast.walk(statement))


@_lowered.register(ast.With)
@_lowered.register(ast.AsyncWith)
def _(node: ast.With | ast.AsyncWith, source: Source) -> _Stmts:
    """Take a context manager for what it gives."""
    heads = [_entered(item, source) for item in node.items]
    return (*heads, *statements(node.body, source))


def _entered(item: ast.withitem, source: Source) -> Stmt:
    line, value = item.context_expr.lineno, expression(item.context_expr, source)
    if item.optional_vars is None:
        return ir.Evaluate(value, line)
    return ir.Assign((expression(item.optional_vars, source),), value, line)


@_lowered.register(ast.Try)
@_lowered.register(getattr(ast, "TryStar", ast.Try))
def _(node: ast.Try, source: Source) -> _Stmts:
    return (
        ir.Try(
            statements(node.body, source),
            tuple([_handler(handler, source) for handler in node.handlers]),
            statements(node.orelse, source),
            statements(node.finalbody, source),
        ),
    )


def _handler(node: ast.ExceptHandler, source: Source) -> tuple[tuple[str, ...], str, _Stmts]:
    caught = node.type.elts if isinstance(node.type, ast.Tuple) else [node.type]
    names = tuple(dotted(kind) for kind in caught if kind)
    return names, node.name or "", statements(node.body, source)


@_lowered.register
def _(node: ast.Match, source: Source) -> _Stmts:
    return cases(node, source, statements)


@_lowered.register
def _(node: ast.Assert, source: Source) -> _Stmts:
    test = expression(node.test, source)
    with source.unsure():
        args = expressions([node.msg] if node.msg else [], source)
    raised = ir.Raise(ir.Call(ir.Name("AssertionError"), args, line=node.lineno))
    return (ir.If(ir.Unary("not", test), (raised,), (), node.lineno),)


@_lowered.register
def _(node: ast.Return, source: Source) -> _Stmts:
    return (ir.Return(optional(node.value, source), node.lineno),)


@_lowered.register
def _(node: ast.Raise, source: Source) -> _Stmts:
    return (ir.Raise(optional(node.exc, source)),)


@_lowered.register
def _(_node: ast.Break, _: Source) -> _Stmts:
    return (ir.Break(),)


@_lowered.register
def _(_node: ast.Continue, _: Source) -> _Stmts:
    return (ir.Continue(),)


@_lowered.register
def _(node: ast.Delete, source: Source) -> _Stmts:
    return (ir.Delete(expressions(node.targets, source)),)


@_lowered.register(ast.Global)
@_lowered.register(ast.Nonlocal)
def _(node: ast.Global | ast.Nonlocal, _: Source) -> _Stmts:
    return (ir.Global(tuple(node.names)),)


@_lowered.register
def _(node: ast.Import, _: Source) -> _Stmts:
    return tuple(
        ir.Import(name.name, None, name.asname or "", line=node.lineno) for name in node.names
    )


@_lowered.register
def _(node: ast.ImportFrom, _: Source) -> _Stmts:
    return tuple(
        ir.Import(node.module or "", name.name, name.asname or name.name, node.level, node.lineno)
        for name in node.names
    )


@_lowered.register(ast.FunctionDef)
@_lowered.register(ast.AsyncFunctionDef)
def _(node: ast.FunctionDef | ast.AsyncFunctionDef, source: Source) -> _Stmts:
    decorators = expressions(node.decorator_list, source)
    function = ir.Function(
        name=node.name,
        file=source.file,
        line=node.lineno,
        params=parameters(node.args, lambda default: optional(default, source)),
        body=(*_taken_apart(node.args, source), *statements(node.body, source)),
        returns=type_of(node.returns),
    )
    return (ir.Define(function, decorators),)


def _taken_apart(node: ast.arguments, source: Source) -> _Stmts:
    """Python 2's parameters `(a, b)`, as `as_python3` wrote them."""
    return tuple(
        ir.Assign((expression(arg.annotation, source),), ir.Name(arg.arg), arg.lineno)
        for arg in node.args
        if arg.arg.startswith(TUPLE_PARAMETER) and isinstance(arg.annotation, ast.Tuple)
    )


@_lowered.register
def _(node: ast.ClassDef, source: Source) -> _Stmts:
    decorators = expressions(node.decorator_list, source)
    bases: tuple[Expr, ...] = expressions(node.bases, source)
    body = (*_declared(node), *statements(node.body, source))
    made = ir.Class(name=node.name, file=source.file, line=node.lineno, bases=bases, body=body)
    return (ir.Define(made, decorators),)


def _declared(node: ast.ClassDef) -> _Stmts:
    """Keep the fields that a decorated class only annotates, for a dataclass, as `__fields__`."""
    bare = [part for part in node.body if isinstance(part, ast.AnnAssign) and part.value is None]
    names = [ir.Const(part.target.id) for part in bare if isinstance(part.target, ast.Name)]
    if not names or not node.decorator_list:
        return ()
    fields = ir.Sequence(tuple(names), "tuple")
    return (ir.Assign((ir.Name("__fields__"),), fields, node.lineno),)

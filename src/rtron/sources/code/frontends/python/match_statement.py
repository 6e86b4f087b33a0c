"""`match` as a chain of `if` (PEP 634); what a pattern of several parts matches is not known."""

import ast
from collections.abc import Callable, Iterable, Iterator

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.expressions import expression
from rtron.sources.code.frontends.python.source_file import Source
from rtron.sources.code.ir import Expr, Stmt

_Statements = Callable[[Iterable[ast.stmt], Source], tuple[Stmt, ...]]


def cases(node: ast.Match, source: Source, statements: _Statements) -> tuple[Stmt, ...]:
    """Lower a `match`: the subject gets a name of its own, no name of the file's."""
    subject = ir.Name(f"<match {node.lineno}>")
    value = expression(node.subject, source)
    chain: tuple[Stmt, ...] = ()
    for case in reversed(node.cases):
        line = case.pattern.lineno
        bound = _bindings(case.pattern, subject, line)
        test = _guarded(case, subject, source)
        chain = (ir.If(test, (*bound, *statements(case.body, source)), chain, line),)
    return (ir.Assign((subject,), value, node.lineno), *chain)


def _guarded(case: ast.match_case, subject: ir.Name, source: Source) -> Expr:
    """Join a case's pattern and guard, which may use names that are bound in the body only."""
    with source.unsure():
        test = _test(case.pattern, subject, source)
        if case.guard is None:
            return test
        guard = expression(case.guard, source)
    if any(_names(case.pattern)):
        return ir.Opaque((test, guard), "case")
    return ir.Logic("and", (test, guard))


def _test(pattern: ast.pattern, subject: ir.Name, source: Source) -> Expr:
    if isinstance(pattern, ast.MatchValue):
        value = expression(pattern.value, source)
        return ir.Binary("==", subject, value, pattern.lineno)
    if isinstance(pattern, ast.MatchSingleton):
        return ir.Binary("is", subject, ir.Const(pattern.value), pattern.lineno)
    if isinstance(pattern, ast.MatchAs):
        return _test(pattern.pattern, subject, source) if pattern.pattern else ir.Const(value=True)
    if isinstance(pattern, ast.MatchOr):
        return ir.Logic("or", tuple([_test(one, subject, source) for one in pattern.patterns]))
    return ir.Opaque((subject,), "case")


def _bindings(pattern: ast.pattern, subject: ir.Name, line: int) -> tuple[Stmt, ...]:
    whole = pattern.name if isinstance(pattern, ast.MatchAs) else None
    return tuple(
        ir.Assign((ir.Name(name),), subject if name == whole else ir.Opaque((subject,)), line)
        for name in _names(pattern)
    )


def _names(pattern: ast.pattern) -> Iterator[str]:
    for node in ast.walk(pattern):
        name = node.rest if isinstance(node, ast.MatchMapping) else getattr(node, "name", None)
        if isinstance(name, str):
            yield name

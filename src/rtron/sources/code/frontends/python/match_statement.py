"""`match` as a chain of `if` (PEP 634); what a pattern of several parts matches is not known."""

import ast
from collections.abc import Callable, Iterable, Iterator

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.expressions import lower_expression
from rtron.sources.code.frontends.python.source_file import SourceFile
from rtron.sources.code.ir import Expr, Stmt

_Statements = Callable[[Iterable[ast.stmt], SourceFile], tuple[Stmt, ...]]


def lower_match(node: ast.Match, source: SourceFile, statements: _Statements) -> tuple[Stmt, ...]:
    """Lower a `match`: the subject gets a name of its own, no name of the file's."""
    subject = ir.Name(f"<match {node.lineno}>")
    value = lower_expression(node.subject, source)
    chain: tuple[Stmt, ...] = ()
    for case in reversed(node.cases):
        line = case.pattern.lineno
        bound = _bindings(case.pattern, subject, line)
        test = _case_test(case, subject, source)
        chain = (ir.If(test, (*bound, *statements(case.body, source)), chain, line),)
    return (ir.Assign((subject,), value, node.lineno), *chain)


def _case_test(case: ast.match_case, subject: ir.Name, source: SourceFile) -> Expr:
    """Join a case's pattern and guard, which may use names that are bound in the body only."""
    with source.conditional():
        test = _pattern_test(case.pattern, subject, source)
        if case.guard is None:
            return test
        guard = lower_expression(case.guard, source)
    if any(_bound_names(case.pattern)):
        return ir.Opaque((test, guard), "case")
    return ir.Logic("and", (test, guard))


def _pattern_test(pattern: ast.pattern, subject: ir.Name, source: SourceFile) -> Expr:
    if isinstance(pattern, ast.MatchValue):
        value = lower_expression(pattern.value, source)
        return ir.Binary("==", subject, value, pattern.lineno)
    if isinstance(pattern, ast.MatchSingleton):
        return ir.Binary("is", subject, ir.Const(pattern.value), pattern.lineno)
    if isinstance(pattern, ast.MatchAs):
        inner = pattern.pattern
        return _pattern_test(inner, subject, source) if inner else ir.Const(value=True)
    if isinstance(pattern, ast.MatchOr):
        tests = [_pattern_test(one, subject, source) for one in pattern.patterns]
        return ir.Logic("or", tuple(tests))
    return ir.Opaque((subject,), "case")


def _bindings(pattern: ast.pattern, subject: ir.Name, line: int) -> tuple[Stmt, ...]:
    subject_name = pattern.name if isinstance(pattern, ast.MatchAs) else None
    return tuple(
        ir.Assign(
            (ir.Name(name),), subject if name == subject_name else ir.Opaque((subject,)), line
        )
        for name in _bound_names(pattern)
    )


def _bound_names(pattern: ast.pattern) -> Iterator[str]:
    for node in ast.walk(pattern):
        name = node.rest if isinstance(node, ast.MatchMapping) else getattr(node, "name", None)
        if isinstance(name, str):
            yield name

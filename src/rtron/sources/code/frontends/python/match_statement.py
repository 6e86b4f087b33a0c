"""`match` as a chain of `if` (PEP 634)."""

import ast
from collections.abc import Callable, Iterable, Iterator

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.expressions import lower_expression
from rtron.sources.code.frontends.python.source_file import SourceFile

_Statements = Callable[[Iterable[ast.stmt], SourceFile], tuple[ir.Stmt, ...]]
_TRUE = ir.Const(value=True)


def lower_match(
    node: ast.Match, source: SourceFile, statements: _Statements
) -> tuple[ir.Stmt, ...]:
    """Lower a `match`: the subject gets a name of its own, no name of the file's."""
    subject = ir.Name(f"<match {node.lineno}>")
    value = lower_expression(node.subject, source)
    chain: tuple[ir.Stmt, ...] = ()
    for case in reversed(node.cases):
        test = _all_of(_case_tests(case, subject, source))
        chain = (ir.If(test, statements(case.body, source), chain, case.pattern.lineno),)
    return (ir.Assign((subject,), value, node.lineno), *chain)


def _case_tests(case: ast.match_case, subject: ir.Expr, source: SourceFile) -> Iterator[ir.Expr]:
    yield from _tests(case.pattern, subject, source)
    if case.guard is not None:
        yield lower_expression(case.guard, source)


def _all_of(tests: Iterable[ir.Expr]) -> ir.Expr:
    found = tuple(tests) or (_TRUE,)
    return found[0] if len(found) == 1 else ir.Logic("and", found)


def _tests(pattern: ast.pattern, subject: ir.Expr, source: SourceFile) -> Iterator[ir.Expr]:
    """Yield what must hold for a pattern, in order; what it binds is bound among them."""
    if isinstance(pattern, ast.MatchValue):
        value = lower_expression(pattern.value, source)
        yield ir.Binary("==", subject, value, pattern.lineno)
    elif isinstance(pattern, ast.MatchSingleton):
        yield ir.Binary("is", subject, ir.Const(pattern.value), pattern.lineno)
    elif isinstance(pattern, ast.MatchAs):
        yield from _tests(pattern.pattern, subject, source) if pattern.pattern else ()
        yield from _binding(pattern.name, subject)
    elif isinstance(pattern, ast.MatchOr):
        yield ir.Logic("or", tuple(_all_of(_tests(p, subject, source)) for p in pattern.patterns))
    elif isinstance(pattern, ast.MatchMapping):
        yield from _mapping_tests(pattern, subject, source)
    elif isinstance(pattern, ast.MatchSequence):
        yield from _sequence_tests(pattern, subject, source)
    elif isinstance(pattern, ast.MatchClass):
        yield from _class_tests(pattern, subject, source)


def _binding(name: str | None, value: ir.Expr) -> Iterator[ir.Expr]:
    """Yield a test that binds a name and always holds: what is not empty counts as true."""
    if name:
        yield ir.SequenceExpr((ir.AssignExpr(ir.Name(name), value),), "tuple")


def _mapping_tests(
    pattern: ast.MatchMapping, subject: ir.Expr, source: SourceFile
) -> Iterator[ir.Expr]:
    yield _is_instance(subject, "dict", pattern)
    for key, inner in zip(pattern.keys, pattern.patterns, strict=True):
        lowered = lower_expression(key, source)
        yield ir.Binary("in", lowered, subject, pattern.lineno)
        yield from _tests(inner, ir.Index(subject, lowered), source)
    yield from _binding(pattern.rest, ir.Opaque((subject,), "rest"))


def _sequence_tests(
    pattern: ast.MatchSequence, subject: ir.Expr, source: SourceFile
) -> Iterator[ir.Expr]:
    parts = pattern.patterns
    starred = [at for at, part in enumerate(parts) if isinstance(part, ast.MatchStar)]
    yield ir.Unary("not", _is_instance(subject, "str", pattern))
    length = ir.Call(ir.Name("len"), (subject,), line=pattern.lineno)
    least = ir.Const(len(parts) - len(starred))
    yield ir.Binary(">=" if starred else "==", length, least, pattern.lineno)
    for at, part in enumerate(parts):
        if isinstance(part, ast.MatchStar):
            yield from _binding(part.name, ir.Opaque((subject,), "rest"))
        else:
            index = at - len(parts) if starred and at > starred[0] else at
            yield from _tests(part, ir.Index(subject, ir.Const(index)), source)


def _class_tests(
    pattern: ast.MatchClass, subject: ir.Expr, source: SourceFile
) -> Iterator[ir.Expr]:
    cls = lower_expression(pattern.cls, source)
    yield ir.Call(ir.Name("isinstance"), (subject, cls), line=pattern.lineno)
    for name, inner in zip(pattern.kwd_attrs, pattern.kwd_patterns, strict=True):
        yield from _tests(inner, ir.Attr(subject, name), source)
    for at, inner in enumerate(pattern.patterns):
        part = subject if _is_builtin(pattern.cls) else ir.Opaque((subject,), f"part {at}")
        yield from _tests(inner, part, source)


def _is_builtin(cls: ast.expr) -> bool:
    """Tell whether the only positional pattern of a class is the subject itself (PEP 634)."""
    names = {"bool", "bytes", "dict", "float", "frozenset", "int", "list", "set", "str", "tuple"}
    return isinstance(cls, ast.Name) and cls.id in names


def _is_instance(subject: ir.Expr, kind: str, pattern: ast.pattern) -> ir.Expr:
    return ir.Call(ir.Name("isinstance"), (subject, ir.Name(kind)), line=pattern.lineno)

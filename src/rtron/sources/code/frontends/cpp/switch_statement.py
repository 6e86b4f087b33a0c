"""`switch` as a chain of `if`: a case that falls through repeats what follows it."""

from dataclasses import dataclass, field

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.lowering_context import Context, line_of
from rtron.sources.code.frontends.cpp.node_lowering import block, expression, statement, states
from rtron.sources.code.frontends.cpp.statements import condition
from rtron.sources.code.ir import (
    Binary,
    Break,
    Const,
    Continue,
    Expr,
    If,
    Logic,
    Raise,
    Return,
    Sequence,
    Stmt,
    Try,
    While,
)

_ENDS = (Break, Continue, Raise, Return)
_MAX_FALLTHROUGH = 64
_MAX_CHAIN = 16


@dataclass(slots=True)
class _Case:
    """The labels in a row before some statements; `default` marks the default's."""

    labels: list[Expr] = field(default_factory=list)
    default: bool = False
    body: tuple[Stmt, ...] = ()
    line: int = 0


@states("switch_statement")
def _switch(context: Context, node: Node, out: list[Stmt]) -> None:
    subject = condition(context, node.child_by_field_name("condition"), out)
    cases = _cases(context, node.child_by_field_name("body"), out)
    bodies = _fallen([case.body for case in cases])
    for case, body in zip(cases, bodies, strict=True):
        case.body = body[:-1] if body and isinstance(body[-1], Break) else body
    chain = _chain(subject, cases)
    if any(_breaks(case.body) for case in cases):
        chain = (While(Const(value=False), chain, first=True, line=line_of(node)),)
    out += chain


def _cases(context: Context, body: Node | None, out: list[Stmt]) -> list[_Case]:
    cases: list[_Case] = []
    for child in body.named_children if body else ():
        if child.type == "case_statement":
            _add_case(context, child, cases)
        elif cases:
            cases[-1].body += block(context, [child])
        else:
            statement(context, child, out)
    return cases


def _add_case(context: Context, node: Node, cases: list[_Case]) -> None:
    value = node.child_by_field_name("value")
    if not cases or cases[-1].body:
        cases.append(_Case(line=line_of(node)))
    case = cases[-1]
    rest = node.named_children
    if value is None:
        case.default = True
    else:
        case.labels.append(expression(context, value))
        rest = rest[1:]
    case.body += block(context, rest)


def _fallen(bodies: list[tuple[Stmt, ...]]) -> list[tuple[Stmt, ...]]:
    """Return the bodies, each with those behind it as far as it falls through."""
    fallen: list[tuple[Stmt, ...]] = []
    behind: tuple[Stmt, ...] = ()
    through = 0
    for whole in reversed(bodies):
        body = _until_end(whole)
        ends = bool(body) and isinstance(body[-1], _ENDS)
        through = 0 if ends or through >= _MAX_FALLTHROUGH else through + 1
        behind = (*body, *behind) if through else body
        fallen.append(behind)
    return fallen[::-1]


def _until_end(body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
    for at, stmt in enumerate(body):
        if isinstance(stmt, _ENDS):
            return body[: at + 1]
    return body


def _breaks(body: tuple[Stmt, ...]) -> bool:
    """Return whether a `break` deep in a case leaves the switch."""
    for stmt in body:
        if isinstance(stmt, Break):
            return True
        if isinstance(stmt, If) and (_breaks(stmt.body) or _breaks(stmt.orelse)):
            return True
        if isinstance(stmt, Try) and any(map(_breaks, (stmt.body, *(h[2] for h in stmt.handlers)))):
            return True
    return False


def _chain(subject: Expr, cases: list[_Case]) -> tuple[Stmt, ...]:
    default = next((case.body for case in cases if case.default), ())
    return _tests(subject, [case for case in cases if not case.default], default)


def _tests(subject: Expr, cases: list[_Case], orelse: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
    """Return the chain; a long one is parted by which half a label is in, so that it stays flat."""
    if len(cases) > _MAX_CHAIN:
        half = len(cases) // 2
        labels = tuple(label for case in cases[:half] for label in case.labels)
        first = _tests(subject, cases[:half], ())
        within = Binary("in", subject, Sequence(labels), cases[0].line)
        return (If(within, first, _tests(subject, cases[half:], orelse), cases[0].line),)
    for case in reversed(cases):
        orelse = (If(_is_one(subject, case), case.body, orelse, case.line),)
    return orelse


def _is_one(subject: Expr, case: _Case) -> Expr:
    tests = tuple(Binary("==", subject, label, case.line) for label in case.labels)
    return tests[0] if len(tests) == 1 else Logic("or", tests)

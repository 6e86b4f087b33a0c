"""`switch` as a chain of `if`: a case that falls through repeats what follows it."""

from dataclasses import dataclass, field

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.lowering_context import (
    LoweringContext,
    line_of,
    lower_block,
    lower_expression,
    lower_statement,
    lowers_statement,
)
from rtron.sources.code.frontends.cpp.statements import lower_condition

_EXITS = (ir.Break, ir.Continue, ir.Raise, ir.Return)
_MAX_FALLTHROUGH = 64
_MAX_CHAIN = 16


@dataclass(slots=True)
class _SwitchCase:
    """The labels in a row before some statements; `default` marks the default's."""

    labels: list[ir.Expr] = field(default_factory=list)
    default: bool = False
    body: tuple[ir.Stmt, ...] = ()
    line: int = 0


@lowers_statement("switch_statement")
def _switch(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    subject = lower_condition(context, node.child_by_field_name("condition"), out)
    if not isinstance(subject, (ir.Attr, ir.Const, ir.Name)):
        subject = _evaluate_once(subject, line_of(node), out)
    cases = _read_cases(context, node.child_by_field_name("body"), out)
    named = (label.id for case in cases for label in case.labels if isinstance(label, ir.Name))
    context.labels.append(frozenset(named))
    bodies = _with_fallthrough(context, line_of(node), [case.body for case in cases])
    for case, body in zip(cases, bodies, strict=True):
        case.body = body[:-1] if body and isinstance(body[-1], ir.Break) else body
    chain = _if_chain(subject, cases)
    if any(_breaks(case.body) for case in cases):
        chain = (ir.Breakable(chain, line_of(node)),)
    out += chain


def _evaluate_once(subject: ir.Expr, line: int, out: list[ir.Stmt]) -> ir.Name:
    """Return a variable that holds what is switched on, which each case asks about."""
    variable = ir.Name(f"switch@{line}")
    out.append(ir.Declare(variable.id, None, subject, line=line))
    return variable


def _read_cases(
    context: LoweringContext, body: Node | None, out: list[ir.Stmt]
) -> list[_SwitchCase]:
    cases: list[_SwitchCase] = []
    for child in body.named_children if body else ():
        if child.type == "case_statement":
            _add_case(context, child, cases)
        elif cases:
            cases[-1].body += lower_block(context, [child])
        else:
            lower_statement(context, child, out)
    return cases


def _add_case(context: LoweringContext, node: Node, cases: list[_SwitchCase]) -> None:
    value = node.child_by_field_name("value")
    if not cases or cases[-1].body:
        cases.append(_SwitchCase(line=line_of(node)))
    case = cases[-1]
    rest = node.named_children
    if value is None:
        case.default = True
    else:
        case.labels.append(lower_expression(context, value))
        rest = rest[1:]
    case.body += lower_block(context, rest)


def _with_fallthrough(
    context: LoweringContext, line: int, bodies: list[tuple[ir.Stmt, ...]]
) -> list[tuple[ir.Stmt, ...]]:
    """Return the bodies, each with those behind it as far as it falls through."""
    result: list[tuple[ir.Stmt, ...]] = []
    following: tuple[ir.Stmt, ...] = ()
    through = 0
    for full_body in reversed(bodies):
        body = _until_exit(full_body)
        exits = bool(body) and isinstance(body[-1], _EXITS)
        if not exits and through == _MAX_FALLTHROUGH:
            context.add_problem(line, "falls through more cases than are read")
        through = 0 if exits or through >= _MAX_FALLTHROUGH else through + 1
        following = (*body, *following) if through else body
        result.append(following)
    return result[::-1]


def _until_exit(body: tuple[ir.Stmt, ...]) -> tuple[ir.Stmt, ...]:
    for at, stmt in enumerate(body):
        if isinstance(stmt, _EXITS):
            return body[: at + 1]
    return body


def _breaks(body: tuple[ir.Stmt, ...]) -> bool:
    """Return whether a `break` deep in a case leaves the switch."""
    for stmt in body:
        if isinstance(stmt, ir.Break):
            return True
        if isinstance(stmt, ir.If) and (_breaks(stmt.body) or _breaks(stmt.orelse)):
            return True
        if isinstance(stmt, ir.Try) and any(
            map(_breaks, (stmt.body, *(h[2] for h in stmt.handlers)))
        ):
            return True
    return False


def _if_chain(subject: ir.Expr, cases: list[_SwitchCase]) -> tuple[ir.Stmt, ...]:
    default = next((case.body for case in cases if case.default), ())
    return _if_tests(subject, [case for case in cases if not case.default], default)


def _if_tests(
    subject: ir.Expr, cases: list[_SwitchCase], orelse: tuple[ir.Stmt, ...]
) -> tuple[ir.Stmt, ...]:
    """Return the chain; a long one is parted by which half a label is in, so that it stays flat."""
    if len(cases) > _MAX_CHAIN:
        half = len(cases) // 2
        labels = tuple(label for case in cases[:half] for label in case.labels)
        first = _if_tests(subject, cases[:half], ())
        within = ir.Binary("in", subject, ir.SequenceExpr(labels), cases[0].line)
        return (ir.If(within, first, _if_tests(subject, cases[half:], orelse), cases[0].line),)
    for case in reversed(cases):
        orelse = (ir.If(_label_test(subject, case), case.body, orelse, case.line),)
    return orelse


def _label_test(subject: ir.Expr, case: _SwitchCase) -> ir.Expr:
    tests = tuple(ir.Binary("==", subject, label, case.line) for label in case.labels)
    return tests[0] if len(tests) == 1 else ir.Logic("or", tests)

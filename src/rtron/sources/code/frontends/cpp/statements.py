"""Statements of a function's body."""

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.declarators import declarator
from rtron.sources.code.frontends.cpp.lowering_context import Context, line_of
from rtron.sources.code.frontends.cpp.node_lowering import block, expression, statement, states
from rtron.sources.code.frontends.cpp.operators import discarded
from rtron.sources.code.frontends.cpp.types import named, type_of
from rtron.sources.code.frontends.cpp.variables import bound, declared, local, variable
from rtron.sources.code.ir import (
    Break,
    Const,
    Continue,
    Expr,
    ForEach,
    If,
    Name,
    Raise,
    Return,
    Stmt,
    Try,
    While,
    Yield,
)


@states("compound_statement", "ERROR", "else_clause", "init_statement", "case_statement")
def _block(context: Context, node: Node, out: list[Stmt]) -> None:
    for child in node.named_children:
        statement(context, child, out)


@states("labeled_statement", "attributed_statement")
def _last(context: Context, node: Node, out: list[Stmt]) -> None:
    for child in node.named_children[-1:]:
        statement(context, child, out)


def body_of(context: Context, node: Node | None) -> tuple[Stmt, ...]:
    """Return the statements of a loop's or branch's body."""
    return block(context, [node]) if node else ()


def condition(context: Context, node: Node | None, out: list[Stmt]) -> Expr:
    """Return the test of a condition; what it declares or assigns goes to `out` before."""
    if node is None:
        return Const(value=True)
    first = node.child_by_field_name("initializer")
    if first is not None:
        statement(context, first, out)
    value = node.child_by_field_name("value") or node
    outer, context.out = context.out, out
    test = _declared_test(context, value, out) or expression(context, value)
    context.out = outer
    return test


def _declared_test(context: Context, node: Node, out: list[Stmt]) -> Expr | None:
    if node.type != "declaration":
        return None
    for one in declared(node):
        name = named(context, one.declarator.name)[0]
        out.append(variable(context, node, one, name))
        return Name(name)
    return None


@states("if_statement")
def _if(context: Context, node: Node, out: list[Stmt]) -> None:
    test = condition(context, node.child_by_field_name("condition"), out)
    body = body_of(context, node.child_by_field_name("consequence"))
    orelse = body_of(context, node.child_by_field_name("alternative"))
    out.append(If(test, body, orelse, line_of(node)))


@states("while_statement")
def _while(context: Context, node: Node, out: list[Stmt]) -> None:
    before: list[Stmt] = []
    test = condition(context, node.child_by_field_name("condition"), before)
    out += before
    body = body_of(context, node.child_by_field_name("body"))
    out.append(While(test, body, tuple(before), line=line_of(node)))


@states("do_statement")
def _do(context: Context, node: Node, out: list[Stmt]) -> None:
    before: list[Stmt] = []
    test = condition(context, node.child_by_field_name("condition"), before)
    body = body_of(context, node.child_by_field_name("body"))
    out.append(While(test, body, tuple(before), first=True, line=line_of(node)))


@states("for_statement")
def _for(context: Context, node: Node, out: list[Stmt]) -> None:
    _written(context, node.child_by_field_name("initializer"), out)
    before: list[Stmt] = []
    test = condition(context, node.child_by_field_name("condition"), before)
    out += before
    step: list[Stmt] = []
    _written(context, node.child_by_field_name("update"), step)
    body = body_of(context, node.child_by_field_name("body"))
    out.append(While(test, body, (*step, *before), line=line_of(node)))


def _written(context: Context, node: Node | None, out: list[Stmt]) -> None:
    if node is None:
        return
    if node.type.endswith("_expression"):
        outer, context.out = context.out, out
        discarded(context, node, out)
        context.out = outer
    else:
        statement(context, node, out)


@states("for_range_loop")
def _range(context: Context, node: Node, out: list[Stmt]) -> None:
    _written(context, node.child_by_field_name("initializer"), out)
    values = node.child_by_field_name("right")
    name = declarator(node.child_by_field_name("declarator")).name
    target: Expr = Name("")
    if name is not None:
        binding = name.type == "structured_binding_declarator"
        target = bound(context, name) if binding else Name(*named(context, name))
    iterable = expression(context, values) if values else Const(None)
    body = body_of(context, node.child_by_field_name("body"))
    out.append(ForEach(target, iterable, body, line_of(node)))


@states("return_statement", "co_return_statement")
def _return(context: Context, node: Node, out: list[Stmt]) -> None:
    out.append(Return(_value(context, node), line_of(node)))


@states("throw_statement")
def _throw(context: Context, node: Node, out: list[Stmt]) -> None:
    out.append(Raise(_value(context, node)))


@states("co_yield_statement")
def _yield(context: Context, node: Node, out: list[Stmt]) -> None:
    out.append(Yield(_value(context, node)))


def _value(context: Context, node: Node) -> Expr | None:
    children = node.named_children
    return expression(context, children[0]) if children else None


@states("break_statement")
def _break(_context: Context, _node: Node, out: list[Stmt]) -> None:
    out.append(Break())


@states("continue_statement")
def _continue(_context: Context, _node: Node, out: list[Stmt]) -> None:
    out.append(Continue())


@states("declaration", "field_declaration")
def _declaration(context: Context, node: Node, out: list[Stmt]) -> None:
    type = node.child_by_field_name("type")
    if type is not None and type.child_by_field_name("body") is not None:
        statement(context, type, out)
    local(context, node, out)


@states("try_statement")
def _try(context: Context, node: Node, out: list[Stmt]) -> None:
    body = body_of(context, node.child_by_field_name("body"))
    clauses = [child for child in node.named_children if child.type == "catch_clause"]
    out.append(Try(body, tuple(_handler(context, clause) for clause in clauses)))


def _handler(context: Context, node: Node) -> tuple[tuple[str, ...], str, tuple[Stmt, ...]]:
    body = body_of(context, node.child_by_field_name("body"))
    caught = node.child_by_field_name("parameters")
    if caught is None or not caught.named_children:
        return ("...",), "", body
    param = caught.named_children[0]
    type = type_of(context, param.child_by_field_name("type"))
    name = declarator(param.child_by_field_name("declarator")).name
    return (str(type or "..."),), named(context, name)[0], body

"""Statements of a function's body."""

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
from rtron.sources.code.frontends.cpp.operators import lower_discarded
from rtron.sources.code.frontends.cpp.types import qualified_name, read_declarator, type_of
from rtron.sources.code.frontends.cpp.variables import (
    lower_local,
    lower_variable,
    named_declarators,
    structured_binding,
)


@lowers_statement(
    *("compound_statement", "ERROR", "else_clause", "init_statement", "case_statement"),
    *("seh_try_statement", "seh_except_clause", "seh_finally_clause"),
)
def _block(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    for child in node.named_children:
        lower_statement(context, child, out)


@lowers_statement("labeled_statement", "attributed_statement")
def _lower_last(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    for child in node.named_children[-1:]:
        lower_statement(context, child, out)


def lower_body(context: LoweringContext, node: Node | None) -> tuple[ir.Stmt, ...]:
    """Return the statements of a loop's or branch's body."""
    return lower_block(context, [node]) if node else ()


def lower_condition(context: LoweringContext, node: Node | None, out: list[ir.Stmt]) -> ir.Expr:
    """Return the test of a condition; what it declares or assigns goes to `out` before."""
    if node is None:
        return ir.Const(value=True)
    first = node.child_by_field_name("initializer")
    if first is not None:
        lower_statement(context, first, out)
    value = node.child_by_field_name("value") or node
    outer, context.statements = context.statements, out
    test = _declared_condition(context, value, out) or lower_expression(context, value)
    context.statements = outer
    return test


def _declared_condition(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> ir.Expr | None:
    if node.type != "declaration":
        return None
    for one in named_declarators(node):
        name = qualified_name(context, one.declarator.name)[0]
        out.append(lower_variable(context, node, one, name))
        return ir.Name(name)
    return None


@lowers_statement("if_statement")
def _if(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    test = lower_condition(context, node.child_by_field_name("condition"), out)
    body = lower_body(context, node.child_by_field_name("consequence"))
    orelse = lower_body(context, node.child_by_field_name("alternative"))
    out.append(ir.If(test, body, orelse, line_of(node)))


@lowers_statement("while_statement")
def _while(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    before: list[ir.Stmt] = []
    test = lower_condition(context, node.child_by_field_name("condition"), before)
    out += before
    body = lower_body(context, node.child_by_field_name("body"))
    out.append(ir.While(test, body, tuple(before), line=line_of(node)))


@lowers_statement("do_statement")
def _do(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    before: list[ir.Stmt] = []
    test = lower_condition(context, node.child_by_field_name("condition"), before)
    body = lower_body(context, node.child_by_field_name("body"))
    out.append(ir.While(test, body, tuple(before), first=True, line=line_of(node)))


@lowers_statement("for_statement")
def _for(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    _lower_clause(context, node.child_by_field_name("initializer"), out)
    before: list[ir.Stmt] = []
    test = lower_condition(context, node.child_by_field_name("condition"), before)
    out += before
    step: list[ir.Stmt] = []
    _lower_clause(context, node.child_by_field_name("update"), step)
    body = lower_body(context, node.child_by_field_name("body"))
    out.append(ir.While(test, body, (*step, *before), line=line_of(node)))


def _lower_clause(context: LoweringContext, node: Node | None, out: list[ir.Stmt]) -> None:
    if node is None:
        return
    if node.type.endswith("_expression"):
        outer, context.statements = context.statements, out
        lower_discarded(context, node, out)
        context.statements = outer
    else:
        lower_statement(context, node, out)


@lowers_statement("for_range_loop")
def _range(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    _lower_clause(context, node.child_by_field_name("initializer"), out)
    values = node.child_by_field_name("right")
    declared = read_declarator(node.child_by_field_name("declarator"))
    name = declared.name
    target: ir.Expr = ir.Name("")
    if name is not None:
        binding = name.type == "structured_binding_declarator"
        target = (
            structured_binding(context, name)
            if binding
            else ir.Name(*qualified_name(context, name))
        )
    iterable = lower_expression(context, values) if values else ir.Const(None)
    body = lower_body(context, node.child_by_field_name("body"))
    out.append(ir.ForEach(target, iterable, body, line_of(node), reference=declared.reference))


@lowers_statement("return_statement", "co_return_statement")
def _return(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    out.append(ir.Return(_value(context, node), line_of(node)))


@lowers_statement("goto_statement")
def _goto(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    label = node.child_by_field_name("label")
    out.append(ir.Jump(context.text(label) if label else "", line_of(node)))


@lowers_statement("throw_statement")
def _throw(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    out.append(ir.Raise(_value(context, node)))


@lowers_statement("co_yield_statement")
def _yield(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    out.append(ir.Yield(_value(context, node)))


def _value(context: LoweringContext, node: Node) -> ir.Expr | None:
    children = node.named_children
    return lower_expression(context, children[0]) if children else None


@lowers_statement("break_statement")
def _break(_context: LoweringContext, _node: Node, out: list[ir.Stmt]) -> None:
    out.append(ir.Break())


@lowers_statement("continue_statement")
def _continue(_context: LoweringContext, _node: Node, out: list[ir.Stmt]) -> None:
    out.append(ir.Continue())


@lowers_statement("declaration", "field_declaration")
def _declaration(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    type = node.child_by_field_name("type")
    if type is not None and type.child_by_field_name("body") is not None:
        lower_statement(context, type, out)
    lower_local(context, node, out)


@lowers_statement("try_statement")
def _try(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    body = lower_body(context, node.child_by_field_name("body"))
    clauses = [child for child in node.named_children if child.type == "catch_clause"]
    out.append(ir.Try(body, tuple(_handler(context, clause) for clause in clauses)))


def _handler(
    context: LoweringContext, node: Node
) -> tuple[tuple[str, ...], str, tuple[ir.Stmt, ...]]:
    body = lower_body(context, node.child_by_field_name("body"))
    caught = node.child_by_field_name("parameters")
    if caught is None or not caught.named_children:
        return ("...",), "", body
    param = caught.named_children[0]
    type = type_of(context, param.child_by_field_name("type"))
    name = read_declarator(param.child_by_field_name("declarator")).name
    return (str(type or "..."),), qualified_name(context, name)[0], body

"""Operators of C++; an assignment within an expression is put before its statement."""

from tree_sitter import Node

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.lowering_context import (
    MAX_DEPTH,
    LoweringContext,
    line_of,
    lower_expression,
    lower_expressions,
    lower_opaque,
    lowers_expression,
    lowers_statement,
)

_LOGIC = {"&&": "and", "||": "or", "and": "and", "or": "or"}
_ALTERNATIVE_TOKENS = {"bitand": "&", "bitor": "|", "xor": "^", "not_eq": "!="}
_BINARY = {"+", "-", "*", "/", "%", "<<", ">>", "&", "|", "^", "==", "!=", "<", "<=", ">", ">="}
_UNARY = {"!": "not", "not": "not", "-": "-", "+": "+", "~": "~", "compl": "~"}
_MAX_CHAIN = MAX_DEPTH // 2


def _operator(context: LoweringContext, node: Node) -> str:
    found = node.child_by_field_name("operator")
    return context.text(found) if found else ""


@lowers_expression("binary_expression")
def _binary(context: LoweringContext, node: Node) -> ir.Expr:
    """Lower a chain of operators that lean left, `a << b << c`, from its left end."""
    chain: list[tuple[str, Node, Node]] = []
    left: Node | None = node
    while left is not None and left.type == "binary_expression":
        right = left.child_by_field_name("right")
        if right is None:
            break
        chain.append((_operator(context, left), left, right))
        left = left.child_by_field_name("left")
    if left is None or not chain:
        return lower_opaque(context, node)
    return _fold_chain(context, left, chain[::-1])


def _fold_chain(
    context: LoweringContext, first: Node, chain: list[tuple[str, Node, Node]]
) -> ir.Expr:
    value = lower_expression(context, first)
    cut = len(chain) - _MAX_CHAIN
    if cut > 0:
        rest = [right for _, _, right in chain[:cut]]
        value = ir.Opaque((value, *lower_expressions(context, rest)), context.text(first)[:60])
        chain = chain[cut:]
    for operator, node, right in chain:
        value = _combine(context, operator, value, node, right)
    return value


def _combine(
    context: LoweringContext, operator: str, left: ir.Expr, node: Node, right: Node
) -> ir.Expr:
    if operator in _LOGIC:
        word, operand = _LOGIC[operator], _lower_conditionally(context, right)
        flat = left.operands if isinstance(left, ir.Logic) and left.operator == word else (left,)
        return ir.Logic(word, (*flat, operand))
    operator = _ALTERNATIVE_TOKENS.get(operator, operator)
    value = lower_expression(context, right)
    if operator in _BINARY:
        return ir.Binary(operator, left, value, line_of(node))
    return ir.Opaque((left, value), context.text(node)[:60])


def _lower_conditionally(context: LoweringContext, node: Node) -> ir.Expr:
    """Lower an operand that may not be evaluated: nothing of it goes before the statement."""
    outer, context.statements = context.statements, None
    value = lower_expression(context, node)
    context.statements = outer
    return value


@lowers_expression("unary_expression")
def _unary(context: LoweringContext, node: Node) -> ir.Expr:
    operand = node.child_by_field_name("argument")
    operator = _UNARY.get(_operator(context, node))
    if operand is None or operator is None:
        return lower_opaque(context, node)
    value = lower_expression(context, operand)
    if operator == "-" and isinstance(value, ir.Const) and type(value.value) in {int, float}:
        return ir.Const(-value.value)  # type: ignore[operator]
    return ir.Unary(operator, value)


@lowers_expression("conditional_expression")
def _conditional(context: LoweringContext, node: Node) -> ir.Expr:
    test = node.child_by_field_name("condition")
    body = node.child_by_field_name("consequence")
    orelse = node.child_by_field_name("alternative")
    if test is None or body is None or orelse is None:
        return lower_opaque(context, node)
    return ir.Conditional(
        lower_expression(context, test),
        _lower_conditionally(context, body),
        _lower_conditionally(context, orelse),
    )


@lowers_expression("comma_expression")
def _comma(context: LoweringContext, node: Node) -> ir.Expr:
    *before, last = _comma_operands(node)
    if context.statements is None:
        return lower_opaque(context, node)
    for child in before:
        lower_discarded(context, child, context.statements)
    return lower_expression(context, last)


def _comma_operands(node: Node) -> list[Node]:
    """Return the expressions between the commas."""
    found: list[Node] = []
    inner: Node | None = node
    while inner is not None and inner.type == "comma_expression":
        left, right = inner.child_by_field_name("left"), inner.child_by_field_name("right")
        found += [left] if left else []
        inner = right
    return [*found, inner] if inner is not None else found


def lower_discarded(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    """Lower an expression whose value is not used into statements."""
    kind = node.type
    if kind == "assignment_expression":
        out += [assignment] if (assignment := _assignment(context, node)) else []
    elif kind == "update_expression":
        out += [update] if (update := _update(context, node)) else []
    elif kind == "comma_expression":
        for child in _comma_operands(node):
            lower_discarded(context, child, out)
    elif kind == "delete_expression":
        out.append(ir.Delete(lower_expressions(context, node.named_children)))
    else:
        value = lower_expression(context, node)
        out.append(ir.Evaluate(value, line_of(node)))


@lowers_statement("expression_statement")
def _statement(context: LoweringContext, node: Node, out: list[ir.Stmt]) -> None:
    for child in node.named_children:
        lower_discarded(context, child, out)


def _assignment(context: LoweringContext, node: Node) -> ir.Assign | None:
    left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
    targets: list[ir.Expr] = []
    while left is not None and right is not None:
        targets.append(lower_expression(context, left))
        if _operator(context, node) != "=" or right.type != "assignment_expression":
            break
        node = right
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
    if left is None or right is None:
        return None
    value = lower_expression(context, right)
    operator = _operator(context, node).removesuffix("=")
    if operator:
        value = ir.Binary(
            _ALTERNATIVE_TOKENS.get(operator, operator), targets[-1], value, line_of(node)
        )
    return ir.Assign(tuple(targets), value, line_of(node))


def _update(context: LoweringContext, node: Node) -> ir.Assign | None:
    argument = node.child_by_field_name("argument")
    if argument is None:
        return None
    target = lower_expression(context, argument)
    step = _operator(context, node)[:1] or "+"
    return ir.Assign((target,), ir.Binary(step, target, ir.Const(1), line_of(node)), line_of(node))


@lowers_expression("assignment_expression")
def _assignment_value(context: LoweringContext, node: Node) -> ir.Expr:
    assignment = _assignment(context, node) if context.statements is not None else None
    if assignment is None or context.statements is None:
        return lower_opaque(context, node)
    context.statements.append(assignment)
    return assignment.targets[0]


@lowers_expression("update_expression")
def _update_value(context: LoweringContext, node: Node) -> ir.Expr:
    """Put `x++` before the statement; its value, the old one, is `x - 1` then."""
    update = _update(context, node) if context.statements is not None else None
    if update is None or context.statements is None:
        return lower_opaque(context, node)
    context.statements.append(update)
    target = update.targets[0]
    if not node.children[0].is_named:
        return target
    back = "-" if _operator(context, node) == "++" else "+"
    return ir.Binary(back, target, ir.Const(1), line_of(node))


@lowers_expression("delete_expression")
def _delete_value(context: LoweringContext, node: Node) -> ir.Expr:
    return lower_opaque(context, node)

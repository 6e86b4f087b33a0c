"""Operators of C++; an assignment within an expression is put before its statement."""

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.lowering_context import MAX_DEPTH, Context, line_of
from rtron.sources.code.frontends.cpp.node_lowering import (
    expression,
    expressions,
    lowers,
    opaque,
    states,
)
from rtron.sources.code.ir import (
    Assign,
    Binary,
    Conditional,
    Const,
    Delete,
    Evaluate,
    Expr,
    Logic,
    Opaque,
    Stmt,
    Unary,
)

_LOGIC = {"&&": "and", "||": "or", "and": "and", "or": "or"}
_SPELLED = {"bitand": "&", "bitor": "|", "xor": "^", "not_eq": "!="}
_BINARY = {"+", "-", "*", "/", "%", "<<", ">>", "&", "|", "^", "==", "!=", "<", "<=", ">", ">="}
_UNARY = {"!": "not", "not": "not", "-": "-", "+": "+", "~": "~", "compl": "~"}
_MAX_CHAIN = MAX_DEPTH // 2


def _operator(context: Context, node: Node) -> str:
    found = node.child_by_field_name("operator")
    return context.text(found) if found else ""


@lowers("binary_expression")
def _binary(context: Context, node: Node) -> Expr:
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
        return opaque(context, node)
    return _folded(context, left, chain[::-1])


def _folded(context: Context, first: Node, chain: list[tuple[str, Node, Node]]) -> Expr:
    value = expression(context, first)
    cut = len(chain) - _MAX_CHAIN
    if cut > 0:
        rest = [right for _, _, right in chain[:cut]]
        value = Opaque((value, *expressions(context, rest)), context.text(first)[:60])
        chain = chain[cut:]
    for operator, node, right in chain:
        value = _joined(context, operator, value, node, right)
    return value


def _joined(context: Context, operator: str, left: Expr, node: Node, right: Node) -> Expr:
    if operator in _LOGIC:
        word, operand = _LOGIC[operator], _unsure(context, right)
        flat = left.operands if isinstance(left, Logic) and left.operator == word else (left,)
        return Logic(word, (*flat, operand))
    operator = _SPELLED.get(operator, operator)
    value = expression(context, right)
    if operator in _BINARY:
        return Binary(operator, left, value, line_of(node))
    return Opaque((left, value), context.text(node)[:60])


def _unsure(context: Context, node: Node) -> Expr:
    """Lower an operand that may not be evaluated: nothing of it goes before the statement."""
    outer, context.out = context.out, None
    value = expression(context, node)
    context.out = outer
    return value


@lowers("unary_expression")
def _unary(context: Context, node: Node) -> Expr:
    operand = node.child_by_field_name("argument")
    operator = _UNARY.get(_operator(context, node))
    if operand is None or operator is None:
        return opaque(context, node)
    value = expression(context, operand)
    if operator == "-" and isinstance(value, Const) and type(value.value) in {int, float}:
        return Const(-value.value)  # type: ignore[operator]
    return Unary(operator, value)


@lowers("conditional_expression")
def _conditional(context: Context, node: Node) -> Expr:
    test = node.child_by_field_name("condition")
    body = node.child_by_field_name("consequence")
    orelse = node.child_by_field_name("alternative")
    if test is None or body is None or orelse is None:
        return opaque(context, node)
    return Conditional(expression(context, test), _unsure(context, body), _unsure(context, orelse))


@lowers("comma_expression")
def _comma(context: Context, node: Node) -> Expr:
    *before, last = _listed(node)
    if context.out is None:
        return opaque(context, node)
    for child in before:
        discarded(context, child, context.out)
    return expression(context, last)


def _listed(node: Node) -> list[Node]:
    """Return the expressions between the commas."""
    found: list[Node] = []
    inner: Node | None = node
    while inner is not None and inner.type == "comma_expression":
        left, right = inner.child_by_field_name("left"), inner.child_by_field_name("right")
        found += [left] if left else []
        inner = right
    return [*found, inner] if inner is not None else found


def discarded(context: Context, node: Node, out: list[Stmt]) -> None:
    """Lower an expression whose value nobody uses into statements."""
    kind = node.type
    if kind == "assignment_expression":
        out += [assignment] if (assignment := _assignment(context, node)) else []
    elif kind == "update_expression":
        out += [update] if (update := _update(context, node)) else []
    elif kind == "comma_expression":
        for child in _listed(node):
            discarded(context, child, out)
    elif kind == "delete_expression":
        out.append(Delete(expressions(context, node.named_children)))
    else:
        value = expression(context, node)
        out.append(Evaluate(value, line_of(node)))


@states("expression_statement")
def _statement(context: Context, node: Node, out: list[Stmt]) -> None:
    for child in node.named_children:
        discarded(context, child, out)


def _assignment(context: Context, node: Node) -> Assign | None:
    left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
    targets: list[Expr] = []
    while left is not None and right is not None:
        targets.append(expression(context, left))
        if _operator(context, node) != "=" or right.type != "assignment_expression":
            break
        node = right
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
    if left is None or right is None:
        return None
    value = expression(context, right)
    operator = _operator(context, node).removesuffix("=")
    if operator:
        value = Binary(_SPELLED.get(operator, operator), targets[-1], value, line_of(node))
    return Assign(tuple(targets), value, line_of(node))


def _update(context: Context, node: Node) -> Assign | None:
    argument = node.child_by_field_name("argument")
    if argument is None:
        return None
    target = expression(context, argument)
    step = _operator(context, node)[:1] or "+"
    return Assign((target,), Binary(step, target, Const(1), line_of(node)), line_of(node))


@lowers("assignment_expression")
def _assigned(context: Context, node: Node) -> Expr:
    assignment = _assignment(context, node) if context.out is not None else None
    if assignment is None or context.out is None:
        return opaque(context, node)
    context.out.append(assignment)
    return assignment.targets[0]


@lowers("update_expression")
def _updated(context: Context, node: Node) -> Expr:
    """Put `x++` before the statement; its value, the old one, is `x - 1` then."""
    update = _update(context, node) if context.out is not None else None
    if update is None or context.out is None:
        return opaque(context, node)
    context.out.append(update)
    target = update.targets[0]
    if not node.children[0].is_named:
        return target
    back = "-" if _operator(context, node) == "++" else "+"
    return Binary(back, target, Const(1), line_of(node))


@lowers("delete_expression")
def _deleted(context: Context, node: Node) -> Expr:
    return opaque(context, node)

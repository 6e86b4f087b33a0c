"""What a C++ lambda takes from around it ([expr.prim.lambda.capture])."""

from collections.abc import Iterator

from tree_sitter import Node

from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext, line_of
from rtron.sources.code.frontends.cpp.node_lowering import lower_expression
from rtron.sources.code.ir import Declare


def lambda_captures(
    context: LoweringContext, node: Node
) -> tuple[tuple[str, ...], tuple[Declare, ...]]:
    """Return the names that a lambda copies, and the variables that its captures make."""
    taken = node.child_by_field_name("captures")
    entries = taken.named_children if taken else []
    plain = [entry for entry in entries if entry.type == "identifier"]
    by_reference = {context.text(entry) for entry in plain if _is_by_reference(entry)}
    copies = {context.text(entry): None for entry in plain if not _is_by_reference(entry)}
    if any(entry.type == "lambda_default_capture" and entry.text == b"=" for entry in entries):
        copies |= {name: None for name in _body_names(context, node) if name not in by_reference}
    made = [entry for entry in entries if entry.type == "lambda_capture_initializer"]
    return tuple(copies), tuple(_capture_initialiser(context, entry) for entry in made)


def _is_by_reference(entry: Node) -> bool:
    return entry.prev_sibling is not None and entry.prev_sibling.type == "&"


def _body_names(context: LoweringContext, node: Node) -> Iterator[str]:
    """Yield the names that a lambda's body says, those of lambdas in it as well."""
    body = node.child_by_field_name("body")
    left = [body] if body else []
    while left:
        child = left.pop()
        left.extend(child.named_children)
        if child.type == "identifier":
            yield context.text(child)


def _capture_initialiser(context: LoweringContext, entry: Node) -> Declare:
    left, right = entry.child_by_field_name("left"), entry.child_by_field_name("right")
    return Declare(
        context.text(left) if left else "",
        None,
        lower_expression(context, right) if right else None,
        reference=entry.children[0].type == "&",
        line=line_of(entry),
    )

"""The trees that cel-python's parser makes of expressions."""

from functools import cache
from typing import Any

from rtron.messages.expressions.errors import CheckError

_WRAPPERS = frozenset(
    {"expr", "conditionalor", "conditionaland", "relation", "addition", "multiplication"}
    | {"unary", "member", "primary", "paren_expr"}
)


def unwrapped(node: Any) -> Any:  # noqa: ANN401 - a tree
    """Return a part without its brackets, and what else only passes it on."""
    while getattr(node, "data", "") in _WRAPPERS and len(node.children) == 1:
        node = node.children[0]
    return node


def bracket_count(node: Any) -> int:  # noqa: ANN401 - a tree
    """Return how many pairs of brackets are around a part."""
    count = 0
    while getattr(node, "data", "") in _WRAPPERS and len(node.children) == 1:
        count += node.data == "paren_expr"
        node = node.children[0]
    return count


def argument_nodes(rest: tuple[Any, ...]) -> list[Any]:
    """Return what stands between the commas; `rest` is empty where nothing does."""
    return list(rest[0].children) if rest else []


def variable_name(node: Any) -> str:  # noqa: ANN401
    """Return the name that a part is, empty if it is something else."""
    found = unwrapped(node)
    return str(found.children[0]) if found.data == "ident" else ""


@cache
def _parser() -> Any:  # noqa: ANN401 - celpy's
    from celpy.celparser import CELParser  # noqa: PLC0415 - where it is needed only

    return CELParser()


def parse(text: str) -> Any:  # noqa: ANN401 - lark's
    """Return the tree of an expression; CheckError if it is none."""
    from celpy.celparser import CELParseError  # noqa: PLC0415 - as above

    try:
        return _parser().parse(text)
    except CELParseError as error:
        line, column = error.line or 1, error.column or 1
        raise CheckError(f"ERROR: <input>:{line}:{column}: Syntax error") from error

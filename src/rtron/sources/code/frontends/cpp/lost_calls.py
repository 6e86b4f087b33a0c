"""Calls that would make an endpoint and stand in the text, but not in what was lowered of it."""

import re
from collections.abc import Iterator, Mapping
from itertools import islice

from tree_sitter import Node

from rtron.sources.code.endpoint_calls import ENDPOINT_CALL
from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext
from rtron.sources.code.frontends.cpp.macros import Macro

_CALL = re.compile(ENDPOINT_CALL.pattern.encode())
_UNEVALUATED = frozenset(
    [
        *("string_literal", "raw_string_literal", "char_literal", "comment", "decltype"),
        *("sizeof_expression", "alignof_expression", "noexcept", "requires_clause"),
        *("requires_expression", "using_declaration", "static_assert_declaration"),
    ]
)


_MACRO_USE = re.compile(r"\b[A-Z][A-Z0-9_]{2,}\b(?=\s*\()")
_MAX_USES = 200


def endpoint_macros(macros: Mapping[str, Macro]) -> tuple[str, ...]:
    """Return the macros with parameters that hold a call which makes an endpoint."""
    holding = (name for name, macro in macros.items() if ENDPOINT_CALL.search(macro.body))
    return tuple(name for name in holding if macros[name].params is not None)


def unexpanded_macros(code: str) -> tuple[tuple[str, int], ...]:
    """Return what reads like the use of a macro that another file defines, with its line."""
    uses = islice(_MACRO_USE.finditer(code), _MAX_USES)
    return tuple((use.group(), code.count("\n", 0, use.start()) + 1) for use in uses)


def note_lost_calls(context: LoweringContext, root: Node) -> None:
    """Note each call that no lowered expression calls, whatever it was lost by."""
    for start, end in _lost_calls(context):
        node = root.descendant_for_byte_range(start, end)
        if node is not None and not _is_unevaluated(node):
            name = context.source[start:end].decode()
            context.add_problem(node.start_point[0] + 1, f"a call of {name} cannot be read")


def _lost_calls(context: LoweringContext) -> Iterator[tuple[int, int]]:
    """Yield where the names of calls stand that were not noted; both are gone through in order."""
    lowered = iter(sorted(context.called, key=lambda place: place[1]))
    first, last = next(lowered, (0, 0))
    for found in _CALL.finditer(context.source):
        start, end = found.span()
        while last and last < end:
            first, last = next(lowered, (0, 0))
        if not first <= start < last:
            yield start, end


def _is_unevaluated(node: Node) -> bool:
    current: Node | None = node
    while current is not None:
        if current.type in _UNEVALUATED:
            return True
        current = current.parent
    return False

"""Constant expressions of an enum's values, as far as they are integers."""

import operator
from collections.abc import Callable

from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext
from rtron.sources.code.ir import Binary, Const, Expr, Name, Unary

_MAX_BITS = 64
_OPERATIONS: dict[str, Callable[[int, int], int]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "|": operator.or_,
    "&": operator.and_,
    "^": operator.xor,
    "<<": lambda left, right: left << max(0, min(right, _MAX_BITS)),
    ">>": lambda left, right: left >> max(0, min(right, _MAX_BITS)),
}
_SIGNS: dict[str, Callable[[int], int]] = {
    "-": operator.neg,
    "+": operator.pos,
    "~": operator.invert,
}


def integer_value(context: LoweringContext, value: Expr) -> int | None:
    """Return the integer that an expression is, with the enumerators known so far."""
    if isinstance(value, Const):
        return _literal_value(value)
    if isinstance(value, Name):
        scoped = context.enums.get(context.qualified(value.id))
        return context.enums.get(value.id) if scoped is None else scoped
    if isinstance(value, Unary):
        operand = integer_value(context, value.operand)
        sign = _SIGNS.get(value.operator)
        return sign(operand) if sign and operand is not None else None
    return _binary_value(context, value) if isinstance(value, Binary) else None


def _literal_value(value: Const) -> int | None:
    if isinstance(value.value, str) and len(value.value) == 1:
        return ord(value.value)
    return int(value.value) if isinstance(value.value, int) else None


def _binary_value(context: LoweringContext, value: Binary) -> int | None:
    left, right = integer_value(context, value.left), integer_value(context, value.right)
    if left is None or right is None or value.operator not in _OPERATIONS:
        return None
    result = _OPERATIONS[value.operator](left, right)
    return result if result.bit_length() <= _MAX_BITS else None

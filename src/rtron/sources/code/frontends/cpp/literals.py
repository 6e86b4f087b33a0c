"""Literals of C++: strings, characters and numbers (C++17, clause 5.13)."""

import operator
import re
import sys
from collections.abc import Callable

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp.lowering_context import LoweringContext

_ESCAPE = re.compile(
    r"\\(?:([abefnrtv\\'\"?\n])|x([\da-fA-F]+)|([0-7]{1,3})|u([\da-fA-F]{4})|U([\da-fA-F]{8}))"
)
_SIMPLE = {
    "a": "\a", "b": "\b", "e": "\x1b", "f": "\f", "n": "\n", "r": "\r", "t": "\t", "v": "\v",
    "\n": "",
}  # fmt: skip
_RAW = re.compile(r'(?:u8|[uUL])?R"([^()\\\s]{0,16})\((.*)\)\1"', re.DOTALL)
_INTEGER = re.compile(r"(0[xX][\da-fA-F]+|0[bB][01]+|\d+)[uUlLzZ]*")
_FLOAT = re.compile(r"((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[fFlL]?(?:16|32|64|128)?")
_HEX_FLOAT = re.compile(r"(0[xX][\da-fA-F]*\.?[\da-fA-F]*[pP][+-]?\d+)[fFlL]?")
_MAX_DIGITS = 400
_SURROGATES = range(0xD800, 0xE000)


def string_value(text: str) -> str:
    """Return the value of one string or character literal, with its prefix and quotes."""
    raw = _RAW.fullmatch(text)
    if raw:
        return raw[2]
    opened = text.find('"') if '"' in text[:3] else text.find("'")
    body = text[opened + 1 : -1]
    return _ESCAPE.sub(_unescape, body) if "\\" in body else body


def number_value(text: str) -> int | float | None:
    """Return the value of a number literal, None if it is none."""
    sign = -1 if text.startswith("-") else 1
    digits = text.lstrip("+-").replace("'", "").strip()
    if len(digits) > _MAX_DIGITS:
        return None
    if found := _INTEGER.fullmatch(digits):
        return sign * _integer(found[1])
    if found := _FLOAT.fullmatch(digits):
        return sign * float(found[1])
    return sign * _hexadecimal(found[1]) if (found := _HEX_FLOAT.fullmatch(digits)) else None


def _integer(digits: str) -> int:
    octal = digits[0] == "0" and digits.isdigit() and not set(digits) & {"8", "9"}
    return int(digits, 8) if octal else int(digits, 0 if digits[1:2].isalpha() else 10)


def _hexadecimal(digits: str) -> float:
    try:
        return float.fromhex(digits)
    except (ValueError, OverflowError):
        return 0.0


def _unescape(found: re.Match[str]) -> str:
    if found[1]:
        return _SIMPLE.get(found[1], found[1])
    code = int(found[3], 8) if found[3] else int(found[2] or found[4] or found[5], 16)
    return chr(code) if code <= sys.maxunicode and code not in _SURROGATES else "?"


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


def integer_value(context: LoweringContext, value: ir.Expr) -> int | None:
    """Return the integer that an expression is, with the enumerators known so far."""
    if isinstance(value, ir.Const):
        return _literal_value(value)
    if isinstance(value, ir.Name):
        scoped = context.enums.get(context.qualified(value.id))
        return context.enums.get(value.id) if scoped is None else scoped
    if isinstance(value, ir.Unary):
        operand = integer_value(context, value.operand)
        sign = _SIGNS.get(value.operator)
        return sign(operand) if sign and operand is not None else None
    return _binary_value(context, value) if isinstance(value, ir.Binary) else None


def _literal_value(value: ir.Const) -> int | None:
    if isinstance(value.value, str) and len(value.value) == 1:
        return ord(value.value)
    return int(value.value) if isinstance(value.value, int) else None


def _binary_value(context: LoweringContext, value: ir.Binary) -> int | None:
    left, right = integer_value(context, value.left), integer_value(context, value.right)
    if left is None or right is None or value.operator not in _OPERATIONS:
        return None
    result = _OPERATIONS[value.operator](left, right)
    return result if result.bit_length() <= _MAX_BITS else None

"""The expression of an `#if`, evaluated (C++17, clause 19.1): names still unknown are 0.

But for versions that are compared: they come from headers that are not here, and are taken as new.
"""

import operator
import re
from collections.abc import Callable

from rtron.sources.code.frontends.cpp.macros import MacroTable

_DEFINED = re.compile(r"\bdefined\s*(?:\(\s*(\w+)\s*\)|(\w+))")
_HAS_FEATURE = re.compile(r"\b__has_\w+\s*\([^()]*\)")
_CALL = re.compile(r"\b[A-Za-z_]\w*\s*\([^()]*\)")
_TOKEN = re.compile(
    r"\s*(0[xX][\da-fA-F']+|0[bB][01']+|\d[\d']*|[A-Za-z_]\w*|'(?:\\.|[^'\\])'|<<|>>|&&|\|\||[=!<>]=|\S)"
)
_SUFFIXED = re.compile(r"(?<=[\da-fA-F])[uUlLzZ]+\b")
_MAX_TOKENS = 400
_MAX_DEPTH = 60
_WORD_OPERATORS = {"and": "&&", "or": "||", "not": "!"}
_LEVELS: dict[str, int] = {
    **dict.fromkeys(["*", "/", "%"], 10),
    **dict.fromkeys(["+", "-"], 9),
    **dict.fromkeys(["<<", ">>"], 8),
    **dict.fromkeys(["<", "<=", ">", ">="], 7),
    **dict.fromkeys(["==", "!="], 6),
    "&": 5,
    "^": 4,
    "|": 3,
    "&&": 2,
    "||": 1,
}
_OPERATIONS: dict[str, Callable[[int, int], int]] = {
    "*": operator.mul,
    "/": operator.floordiv,
    "%": operator.mod,
    "+": operator.add,
    "-": operator.sub,
    "<<": lambda left, right: left << min(right, 64),
    ">>": lambda left, right: left >> min(right, 64),
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "&": operator.and_,
    "^": operator.xor,
    "|": operator.or_,
    "&&": lambda left, right: bool(left and right),
    "||": lambda left, right: bool(left or right),
}
_ORDERINGS = frozenset({"<", "<=", ">", ">="})
_NEWEST = 2**31
_UNARY: dict[str, Callable[[int], int]] = {
    "!": operator.not_,
    "-": operator.neg,
    "+": operator.pos,
    "~": operator.invert,
}


def is_true(text: str, macros: MacroTable) -> bool:
    """Return whether a condition is true; raise ValueError where it cannot be read."""

    def is_defined(found: re.Match[str]) -> str:
        return "1" if (found[1] or found[2]) in macros.defined else "0"

    expanded = macros.expand(_HAS_FEATURE.sub("0", _DEFINED.sub(is_defined, text)))
    return bool(_IfExpressionParser(_SUFFIXED.sub("", _CALL.sub("0", expanded))).value())


class _IfExpressionParser:
    """Reads the tokens of one condition by the levels of their operators."""

    def __init__(self, text: str) -> None:
        self._tokens = [_WORD_OPERATORS.get(symbol, symbol) for symbol in _TOKEN.findall(text)]
        self._at = 0
        self._depth = 0
        if len(self._tokens) > _MAX_TOKENS:
            raise ValueError("the condition is too long")

    def value(self) -> int:
        value = self._ternary()
        if self._peek():
            raise ValueError(f"`{self._peek()}` is not expected in a condition")
        return value

    def _peek(self) -> str:
        return self._tokens[self._at] if self._at < len(self._tokens) else ""

    def _next(self) -> str:
        symbol = self._peek()
        self._at += 1
        return symbol

    def _ternary(self) -> int:
        self._enter()
        test = self._binary(1)
        if self._peek() != "?":
            self._depth -= 1
            return test
        self._next()
        body = self._ternary()
        self._expect(":")
        orelse = self._ternary()
        self._depth -= 1
        return body if test else orelse

    def _expect(self, symbol: str) -> None:
        if self._next() != symbol:
            raise ValueError(f"`{symbol}` is missing in a condition")

    def _binary(self, level: int) -> int:
        left = self._unary()
        while _LEVELS.get(self._peek(), 0) >= level:
            symbol = self._next()
            right = self._binary(_LEVELS[symbol] + 1)
            left = _apply(symbol, left, right)
        return left

    def _enter(self) -> None:
        self._depth += 1
        if self._depth > _MAX_DEPTH:
            raise ValueError("the condition is nested too deep")

    def _unary(self) -> int:
        symbol = self._next()
        self._enter()
        if symbol in _UNARY:
            value = int(_UNARY[symbol](self._unary()))
        elif symbol == "(":
            value = self._ternary()
            self._expect(")")
        elif "VERSION" in symbol and self._peek() in _ORDERINGS:
            value = _NEWEST
        else:
            value = _literal(symbol)
        self._depth -= 1
        return value


def _apply(symbol: str, left: int, right: int) -> int:
    try:
        value = int(_OPERATIONS[symbol](left, right))
    except (ArithmeticError, ValueError):
        raise ValueError(f"`{left} {symbol} {right}` has no value") from None
    return value & 0xFFFF_FFFF_FFFF_FFFF if value > 0 else max(value, -(2**63))


def _literal(symbol: str) -> int:
    if symbol[:1].isalpha() or symbol[:1] == "_":
        return int(symbol == "true")
    if symbol[:1] == "'" and len(symbol) > 1:
        return ord(symbol[-2])
    if not symbol[:1].isdigit():
        raise ValueError(f"`{symbol or 'the end'}` is not expected in a condition")
    digits = symbol.replace("'", "").lower()
    octal = digits[0] == "0" and digits[1:].isdigit()
    return int(digits, 8) if octal else int(digits, 0)

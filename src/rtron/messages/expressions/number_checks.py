"""A comparison with NaN is not known, where CEL says false (IEEE 754): `NaN < 0.2` blocks nothing.

Before an expression is compiled, each comparison is written out with a test of what it compares,
whose failure is an error as CEL's other errors are: `false && error` is false. So an expression may
still judge NaN itself: `math.isNaN(x) || x < 0.2` is true for it.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from rtron.messages.expressions.functions import BRACKETS, CLOSING, TOKEN

NOT_A_NUMBER = "a number is NaN"
"""What the evaluation of a comparison with NaN ends with."""
_TOKENS = re.compile(rf"&&|\|\||[<>=!]=|{TOKEN.pattern}", TOKEN.flags)
_RELATIONS = frozenset({"<", "<=", ">", ">=", "==", "!=", "in"})
_SEPARATORS = frozenset({"&&", "||", "?", ":", ","})
_NEVER_NAN = re.compile(
    r"\s*(?:[-+]?[\d.]+(?:[eE][-+]?\d+)?u?|[bBrR]{0,2}(?:'[^']*'|\"[^\"]*\")|true|false|null)\s*"
)
_EXTREME = re.compile(r"\bmath\s*\.\s*(?:greatest|least)\s*$", re.ASCII)
# The names of its own variables have a prefix that no user would take.
_LEFT, _RIGHT = "rtron_l", "rtron_r"


def check_numbers(text: str) -> str:
    """Return an expression, which was checked, in which each comparison with NaN is an error."""
    return _Rewriter([_without_comment(token) for token in _TOKENS.findall(text)]).part().text


def _without_comment(token: str) -> str:
    return " " if token.startswith("//") else token


@dataclass(slots=True)
class _Part:
    """A piece of text, and whether something is compared in it."""

    text: str = ""
    compares: bool = False

    def append(self, other: "_Part") -> None:
        self.text += other.text
        self.compares |= other.compares


@dataclass(slots=True)
class _Relation:
    """The operands between two separators, and the operators between them."""

    operands: list[_Part] = field(default_factory=lambda: [_Part()])
    operators: list[str] = field(default_factory=list)

    def written_out(self) -> _Part:
        """Return it with its tests; several operators bind to the left."""
        found = self.operands[0]
        for operator, operand in zip(self.operators, self.operands[1:], strict=True):
            found = _Part(_tested(found, operator, operand), compares=True)
        return found


class _Rewriter:
    """Goes over the tokens of a text once."""

    def __init__(self, tokens: Sequence[str]) -> None:
        self._tokens = iter(tokens)

    def part(self, *, is_extreme: bool = False) -> _Part:
        """Return what stands up to the bracket that closes, written out.

        `is_extreme`: these are the numbers of which the greatest or least is taken.
        """
        found, comparison = _Part(), _Relation()
        for word in self._tokens:
            if word in CLOSING:
                break
            if word in _SEPARATORS:
                found.append(_argument(comparison.written_out(), is_extreme=is_extreme))
                found.text += word
                comparison = _Relation()
            elif word in _RELATIONS:
                comparison.operators.append(word)
                comparison.operands.append(_Part())
            else:
                self._append(comparison.operands[-1], word)
        found.append(_argument(comparison.written_out(), is_extreme=is_extreme))
        return found

    def _append(self, operand: _Part, word: str) -> None:
        is_extreme = word == "(" and _EXTREME.search(operand.text) is not None
        operand.text += word
        if word in BRACKETS:
            operand.append(self.part(is_extreme=is_extreme))
            operand.text += BRACKETS[word]


def _argument(part: _Part, *, is_extreme: bool) -> _Part:
    """Return a number of which the greatest is taken so that NaN is not passed over."""
    if not is_extreme or _NEVER_NAN.fullmatch(part.text):
        return part
    test = f"{_LEFT} != {_LEFT} ? {{'': {_LEFT}}}['{NOT_A_NUMBER}'] : {_LEFT}"
    return _Part(f"[{part.text}].map({_LEFT}, {test})[0]", compares=True)


def _tested(left: _Part, operator: str, right: _Part) -> str:
    """Return a comparison; operands that compare, too, are written once: they may be nested."""
    if left.compares or right.compares:
        test = _test(_LEFT, operator, _RIGHT, [_LEFT, _RIGHT])
        return f"[{left.text}].all({_LEFT}, [{right.text}].all({_RIGHT}, {test}))"
    operands = (left.text,) if operator == "in" else (left.text, right.text)
    doubted = [f"({text})" for text in operands if not _NEVER_NAN.fullmatch(text)]
    return f"({_test(left.text, operator, right.text, doubted)})"


def _test(left: str, operator: str, right: str, doubted: Sequence[str]) -> str:
    comparison = f"{left} {operator} {right}"
    if not doubted:
        return comparison
    is_nan = " || ".join(f"{each} != {each}" for each in doubted)
    return f"{is_nan} ? {{'': true}}['{NOT_A_NUMBER}'] : {comparison}"

"""Whether a condition of `if()` holds: True, False, or None where only a build knows."""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.workspace.cmake.command_call import (
    ExpandedArgument,
    Lookup,
    VariableValue,
    split_list,
)
from rtron.sources.workspace.cmake.patterns import plain_pattern

MAX_NESTED = 32

Truth: TypeAlias = bool | None

_TRUE = frozenset({"1", "on", "yes", "true", "y"})
_FALSE = frozenset({"", "0", "off", "no", "false", "n", "ignore", "notfound"})
_NUMBER = re.compile(r"-?\d{1,18}(?:\.\d{1,18})?")
_VERSION = re.compile(r"\d{1,9}(?:\.\d{1,9}){0,7}")
_UNARY = frozenset(
    {"exists", "target", "defined", "command", "policy", "is_directory", "is_symlink"}
    | {"is_absolute", "test"}
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionContext:
    """What a condition depends on: variables, targets so far, files (None: unknown)."""

    variable: Lookup
    is_target: Callable[[str], bool]
    exists: Callable[[str], Truth]


def evaluate_condition(condition: Sequence[ExpandedArgument], facts: ConditionContext) -> Truth:
    """Return the truth of a condition; one that is no condition is unknown."""
    return _ConditionEvaluator(list(condition), facts).evaluate()


class _ConditionEvaluator:
    """Reads a condition from left to right: NOT binds closest, then AND, then OR."""

    def __init__(self, condition: list[ExpandedArgument], facts: ConditionContext) -> None:
        self._rest = condition[::-1]
        self._facts = facts
        self._nested = 0

    def evaluate(self) -> Truth:
        value = self._evaluate_or()
        return None if self._rest else value

    def _evaluate_or(self) -> Truth:
        values = [self._evaluate_and()]
        while self._accept("or"):
            values.append(self._evaluate_and())
        return any_of(values)

    def _evaluate_and(self) -> Truth:
        values = [self._evaluate_not()]
        while self._accept("and"):
            values.append(self._evaluate_not())
        return _not(any_of(map(_not, values)))

    def _evaluate_not(self) -> Truth:
        negations = 0
        while self._accept("not"):
            negations += 1
        value = self._evaluate_single()
        return _not(value) if negations % 2 else value

    def _evaluate_single(self) -> Truth:
        if self._accept("("):
            return self._evaluate_nested()
        if not self._rest:
            return None
        item = self._rest.pop()
        if self._rest and not item.quoted and item.text.lower() in _UNARY:
            return self._evaluate_test(item.text.lower(), self._rest.pop())
        if self._rest and _is_comparison(self._rest[-1]):
            return self._compare(item)
        return self._evaluate_truth(item)

    def _evaluate_nested(self) -> Truth:
        self._nested += 1
        if self._nested > MAX_NESTED:
            self._rest.clear()
            return None
        value = self._evaluate_or()
        self._nested -= 1
        return value if self._accept(")") else None

    def _evaluate_test(self, test: str, item: ExpandedArgument) -> Truth:
        if not item.known:
            return None
        if test == "defined":
            value = self._facts.variable(item.text)
            return (value is not None and value.known and bool(value.text)) or None
        if test == "target":
            return self._facts.is_target(item.text) or None
        if test in {"exists", "is_directory"}:
            return self._facts.exists(item.text)
        return item.text.startswith("/") if test == "is_absolute" else None

    def _compare(self, left: ExpandedArgument) -> Truth:
        operator = self._rest.pop().text.lower()
        right = self._operand(self._rest.pop()) if self._rest else None
        value = self._operand(left)
        bare = not left.quoted and not left.expanded and self._facts.variable(left.text) is None
        if bare and operator != "in_list" and not _NUMBER.fullmatch(left.text):
            return None
        if right is None or not (value.known and right.known):
            return None
        return COMPARISONS[operator](value.text, right.text)

    def _operand(self, item: ExpandedArgument) -> VariableValue:
        value = None if item.quoted else self._facts.variable(item.text)
        return value or VariableValue(item.text, item.known)

    def _evaluate_truth(self, item: ExpandedArgument) -> Truth:
        constant = constant_truth(item.text)
        if not item.known or constant is not None or item.quoted:
            return bool(constant) if item.known else None
        value = self._facts.variable(item.text)
        if value is None or not value.known:
            return None
        return constant_truth(value.text) is not False

    def _accept(self, word: str) -> bool:
        here = self._rest[-1] if self._rest else None
        if here is None or here.quoted or here.text.lower() != word:
            return False
        self._rest.pop()
        return True


def constant_truth(text: str) -> Truth:
    """Return what a constant means; None if it is no constant."""
    word = text.lower()
    if word in _FALSE or word.endswith("-notfound"):
        return False
    if word in _TRUE:
        return True
    return float(word) != 0 if _NUMBER.fullmatch(word) else None


def any_of(values: Iterable[Truth]) -> Truth:
    """Return whether one of the values is true; unknown if none is and one is unknown."""
    seen = set(values)
    if True in seen:
        return True
    return None if None in seen else False


def _not(value: Truth) -> Truth:
    return None if value is None else not value


def _is_comparison(item: ExpandedArgument) -> bool:
    return not item.quoted and item.text.lower() in COMPARISONS


def _by_number(*signs: int) -> Callable[[str, str], Truth]:
    def compare(left: str, right: str) -> Truth:
        if not (_NUMBER.fullmatch(left) and _NUMBER.fullmatch(right)):
            return None
        return _sign(float(left), float(right)) in signs

    return compare


def _by_version(*signs: int) -> Callable[[str, str], Truth]:
    def compare(left: str, right: str) -> Truth:
        if not (_VERSION.fullmatch(left) and _VERSION.fullmatch(right)):
            return None
        return _sign(_version(left), _version(right)) in signs

    return compare


def _version(text: str) -> tuple[int, ...]:
    parts = [int(part) for part in text.split(".")]
    return tuple(parts + [0] * (8 - len(parts)))


def _sign(left: float | str | tuple[int, ...], right: float | str | tuple[int, ...]) -> int:
    return (left > right) - (left < right)  # type: ignore[operator]


def _matches(text: str, pattern: str) -> Truth:
    """Return whether a pattern is found; None where it is not plain."""
    plain = plain_pattern(pattern)
    return None if plain is None else plain.match(text) is not None


COMPARISONS: dict[str, Callable[[str, str], Truth]] = {
    "strequal": lambda left, right: left == right,
    "strless": lambda left, right: left < right,
    "strgreater": lambda left, right: left > right,
    "in_list": lambda left, right: left in split_list(right),
    "matches": _matches,
    "equal": _by_number(0),
    "less": _by_number(-1),
    "greater": _by_number(1),
    "less_equal": _by_number(-1, 0),
    "greater_equal": _by_number(0, 1),
    "version_equal": _by_version(0),
    "version_less": _by_version(-1),
    "version_greater": _by_version(1),
    "version_less_equal": _by_version(-1, 0),
    "version_greater_equal": _by_version(0, 1),
}

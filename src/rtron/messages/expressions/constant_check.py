"""Whether an expression has one value whatever the message says, such as `x > 5.0 && x < 3.0`.

Each term is tried with values on both sides of all that it is compared with, in every combination.
Different terms count as independent, and what is not understood may be either: an answer is right,
and not every constant is found.
"""

import math
import operator
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise, product

from rtron.messages.common.definition import Definition
from rtron.messages.expressions.functions import BRACKETS, CLOSING, TOKEN

MAX_STEPS = 200_000
"""How many combinations, times words, are tried for one plan: of more nothing is told."""
_Value = bool | float | str
_Test = Callable[[Mapping[str, _Value]], bool]
_Words = Sequence[str]
_TOKENS = re.compile(rf"&&|\|\||[<>=!]=|\d+\.\d*(?:[eE][-+]?\d+)?|{TOKEN.pattern}", TOKEN.flags)
_COMPARISONS: Mapping[str, Callable[..., bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_NUMBER = re.compile(r"-?\d+(\.\d*)?([eE][-+]?\d+)?")
_PLAIN_TEXT = re.compile(r"""'[^'\\\n]*'|"[^"\\\n]*\"""")
_TRUTHS = {"true": True, "false": False}
_NOT_NEGATIVE = ("distance", "size")
_LARGEST = 2**53  # beyond it a float leaves out whole numbers
_INTEGERS = {
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
}


def constant_value(
    text: str, definition: Definition, subject: str, most_steps: int = MAX_STEPS
) -> bool | None:
    """Return what a boolean expression, which was checked, always is; None if that is not known.

    It is about messages of this type, which it calls `subject`. No more steps are taken than given.
    """
    words = [w for w in _TOKENS.findall(text) if not w.isspace() and not w.startswith("//")]
    reader = _ConditionReader()
    test = reader.condition(words)
    samples = [
        _samples(values, _integer_bounds(term, definition, subject) or _real_bounds(term))
        for term, values in reader.values.items()
    ]
    if not 0 < math.prod(map(len, samples)) * len(words) <= most_steps:
        return None
    results = (test(dict(zip(reader.values, case, strict=True))) for case in product(*samples))
    first = next(results)
    return first if all(each == first for each in results) else None


class _ConditionReader:
    """Reads how a condition combines its terms; `values` are what each is compared with."""

    def __init__(self) -> None:
        self.values: dict[str, set[_Value]] = {}

    def condition(self, words: _Words) -> _Test:
        """Return a test of a condition."""
        choice = _split_choice(words)
        if choice:
            chosen, one, other = map(self.condition, choice)
            return lambda values: one(values) if chosen(values) else other(values)
        alternatives = _split(words, "||")
        if len(alternatives) > 1:
            tests = [self.condition(part) for part in alternatives]
            return lambda values: any(test(values) for test in tests)
        tests = [self._relation(part) for part in _split(words, "&&")]
        return lambda values: all(test(values) for test in tests)

    def _relation(self, words: _Words) -> _Test:
        while list(words[:2]) == ["!", "!"]:
            words = words[2:]
        for index, word in _outer(words):
            if word in _COMPARISONS:
                return self._comparison(words[:index], word, words[index + 1 :], words)
            if word == "in":
                return self._membership(words[:index], words[index + 1 :], words)
        if words[:1] == ["!"]:
            test = self._relation(words[1:])
            return lambda values: not test(values)
        return self.condition(words[1:-1]) if _is_bracketed(words, "(") else self._truth(words)

    def _comparison(self, left: _Words, sign: str, right: _Words, whole: _Words) -> _Test:
        if _literal(left) is not None:
            left, sign, right = right, _MIRRORED.get(sign, sign), left
        value, compare = _literal(right), _COMPARISONS[sign]
        if list(left) == list(right) or (value is not None and _is_like(_literal(left), value)):
            is_true = compare(0, 0) if list(left) == list(right) else compare(_literal(left), value)
            return lambda _: is_true
        if value is None or _literal(left) is not None:
            return self._truth(whole)
        term = self._compared(left, {value})
        return lambda values: compare(values[term], value)

    def _membership(self, left: _Words, right: _Words, whole: _Words) -> _Test:
        parts = _split(right[1:-1], ",") if _is_bracketed(right, "[") else []
        literals = {literal for part in parts if (literal := _literal(part)) is not None}
        if not parts or len(literals) < len(parts) or _literal(left) is not None:
            return self._truth(whole)
        term = self._compared(left, literals)
        return lambda values: values[term] in literals

    def _truth(self, words: _Words) -> _Test:
        """Return a test of what is true or false, and nothing more is known of it."""
        value = _literal(words)
        if isinstance(value, bool):
            return lambda _: value
        term = self._compared(words, {True})
        return lambda values: values[term] is True

    def _compared(self, words: _Words, values: set[_Value]) -> str:
        """Note what a term is compared with, and return its name."""
        while _is_bracketed(words, "("):
            words = words[1:-1]
        term = " ".join(words)
        self.values.setdefault(term, set()).update(values)
        return term


def _literal(words: _Words) -> _Value | None:
    text = "".join(words)
    if text in _TRUTHS:
        return _TRUTHS[text]
    if _NUMBER.fullmatch(text):
        return float(text) if re.search("[.eE]", text) else int(text)
    return text[1:-1] if _PLAIN_TEXT.fullmatch(text) else None


def _is_like(one: _Value | None, other: _Value) -> bool:
    """Return whether two values are both texts, both truths or both numbers."""
    kinds = [next((k for k in (bool, str) if isinstance(each, k)), float) for each in (one, other)]
    return one is not None and kinds[0] is kinds[1]


def _split_choice(words: _Words) -> tuple[_Words, _Words, _Words] | None:
    """Return the parts of `condition ? one : other`; None if it is no such choice."""
    marks = [(index, word) for index, word in _outer(words) if word in ("?", ":")]
    depth = 0
    for index, word in marks:
        depth += 1 if word == "?" else -1
        if not depth:
            first = marks[0][0]
            return words[:first], words[first + 1 : index], words[index + 1 :]
    return None


def _outer(words: _Words) -> Iterator[tuple[int, str]]:
    """Yield the words outside of brackets, each with its place."""
    depth = 0
    for index, word in enumerate(words):
        depth -= word in CLOSING
        if not depth and word not in CLOSING:
            yield index, word
        depth += word in BRACKETS


def _split(words: _Words, separator: str) -> list[_Words]:
    places = [index for index, word in _outer(words) if word == separator]
    begins = [0, *(place + 1 for place in places)]
    return [words[a:b] for a, b in zip(begins, (*places, len(words)), strict=True)]


def _is_bracketed(words: _Words, bracket: str) -> bool:
    """Return whether one pair of brackets is around all words."""
    return words[:1] == [bracket] and [index for index, _ in _outer(words)] == [0]


def _samples(values: set[_Value], bounds: tuple[float, float]) -> Sequence[_Value]:
    """Return values of each kind that comparisons with `values` tell apart; none if they differ."""
    if all(isinstance(value, bool) for value in values):
        return (True, False)
    texts = [value for value in values if isinstance(value, str)]
    if texts:
        return ("", *texts, *(f"{text}\0" for text in texts)) if len(texts) == len(values) else ()
    numbers = sorted(float(v) for v in values if not isinstance(v, (bool, str)))
    if len(numbers) < len(values) or any(abs(number) > _LARGEST for number in numbers):
        return ()
    if math.isinf(bounds[1]):
        inside = sorted({bounds[0], *(number for number in numbers if bounds[0] <= number)})
        between = (a + (b - a) / 2 for a, b in pairwise(inside))
        return (*inside, *(n for n in between if math.isfinite(n)), math.inf)
    near = {math.floor(n) + step for n in numbers for step in (-1, 0, 1, 2)}
    return [n for n in near.union(bounds) if bounds[0] <= n <= bounds[1]]


def _integer_bounds(term: str, definition: Definition, subject: str) -> tuple[int, int] | None:
    """Return the least and greatest value of a field of whole numbers; None for all else."""
    first, *names = term.split(" . ")
    found: Definition | None = definition if first == subject else None
    for name in names[:-1]:
        field = found.find(name) if found else None
        found = found.nested.get(field.type) if found and field and not field.array else None
    last = found.find(names[-1]) if found and names else None
    return _INTEGERS.get(last.type) if last and not last.array else None


def _real_bounds(term: str) -> tuple[float, float]:
    """Return the least and greatest value of a term that is no field of whole numbers."""
    words = term.split(" ")
    is_size = words[-3:] == ["size", "(", ")"] and all(
        w.isidentifier() or w == "." for w in words[:-3]
    )
    is_call = words[0] in _NOT_NEGATIVE and _is_bracketed(words[1:], "(")
    return (0 if is_size or is_call else -math.inf, math.inf)

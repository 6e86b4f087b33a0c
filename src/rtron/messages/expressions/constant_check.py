"""Whether an expression has one value whatever the message says, such as `x > 5.0 && x < 3.0`.

Each term is tried with values on both sides of all that it is compared with, in every combination.
Different terms count as independent, and what is not understood may be either: an answer is right,
and not every constant is found. Written in Python's words an expression has the same shape, so
Python's own parser takes it apart; nothing is run.
"""

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise, product

from rtron.messages.common.definition import Definition
from rtron.messages.expressions.functions import TOKEN
from rtron.messages.expressions.python_literals import literal_value

MAX_STEPS = 200_000
"""How many combinations, times words, are tried for one plan: of more nothing is told."""
_Value = bool | float | str
_Test = Callable[[Mapping[str, _Value]], bool]
_NUMBER = r"0x[\da-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_TOKENS = re.compile(rf"&&|\|\||[<>=!]=|{_NUMBER}|{TOKEN.pattern}", TOKEN.flags)
_IN_PYTHON = {"&&": "and", "||": "or", "!": "~", "true": "True", "false": "False"}
_IN_PYTHON |= {"?": "if", ":": "else"}  # `a ? b : c` as `a if b else c`: a shape, not a meaning
_COMPARISONS: Mapping[type[ast.cmpop], Callable[..., bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_MIRRORED = {ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Gt: ast.Lt, ast.GtE: ast.LtE}
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
    try:
        words = _words_in_python(text)
        reader = _ConditionReader(" ".join(words))
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return None
    samples = [
        _samples(values, _integer_bounds(term, definition, subject) or reader.bounds[term])
        for term, values in reader.values.items()
    ]
    if not 0 < math.prod(map(len, samples)) * len(words) <= most_steps:
        return None
    cases = (dict(zip(reader.values, case, strict=True)) for case in product(*samples))
    results = map(reader.test, cases)
    first = next(results)
    return first if all(each == first for each in results) else None


def _words_in_python(text: str) -> list[str]:
    """Return the words of an expression, in whose place Python has a word of the same rank."""
    words: list[str] = []
    for word in _TOKENS.findall(text):
        if word.isspace() or word.startswith("//"):
            continue
        if word == "!" and words[-1:] == ["~"]:
            words.pop()
        elif word[-1] in "'\"":
            kind = "BYTES_LIT" if word[0] in "bB" else "STRING_LIT"
            words.append(repr(literal_value(kind, word)))
        else:
            words.append(_IN_PYTHON.get(word, word))
    return words


class _ConditionReader:
    """Reads how a condition combines its terms; `test` is the whole.

    `values` are what each term is compared with, `bounds` the least and greatest of a real one.
    """

    def __init__(self, text: str) -> None:
        self._text = text.encode()
        self.values: dict[str, set[_Value]] = {}
        self.bounds: dict[str, tuple[float, float]] = {}
        self.test = self._test(ast.parse(text, mode="eval").body)

    def _test(self, node: ast.expr) -> _Test:
        match node:
            case ast.IfExp():
                chosen, one, other = map(self._test, (node.body, node.test, node.orelse))
                return lambda values: one(values) if chosen(values) else other(values)
            case ast.BoolOp():
                tests = [self._test(part) for part in node.values]
                join = any if isinstance(node.op, ast.Or) else all
                return lambda values: join(test(values) for test in tests)
            case ast.UnaryOp(op=ast.Invert()):
                test = self._test(node.operand)
                return lambda values: not test(values)
            case ast.Compare(ops=[ast.In()], comparators=[ast.List(elts=parts)]):
                return self._membership(node, [_literal(part) for part in parts])
            case ast.Compare(ops=[sign]) if type(sign) in _COMPARISONS:
                return self._comparison(node, type(sign))
        return self._truth(node)

    def _comparison(self, node: ast.Compare, sign: type[ast.cmpop]) -> _Test:
        left, right = node.left, node.comparators[0]
        if _literal(left) is not None:
            left, sign, right = right, _MIRRORED.get(sign, sign), left
        value, compare = _literal(right), _COMPARISONS[sign]
        is_same = self._source(left) == self._source(right)
        if is_same or (value is not None and _is_like(_literal(left), value)):
            is_true = compare(0, 0) if is_same else compare(_literal(left), value)
            return lambda _: is_true
        if value is None or _literal(left) is not None:
            return self._truth(node)
        term = self._compared(left, {value})
        return lambda values: compare(values[term], value)

    def _membership(self, node: ast.Compare, parts: Sequence[_Value | None]) -> _Test:
        literals = {part for part in parts if part is not None}
        if not parts or None in parts or _literal(node.left) is not None:
            return self._truth(node)
        term = self._compared(node.left, literals)
        return lambda values: values[term] in literals

    def _truth(self, node: ast.expr) -> _Test:
        """Return a test of what is true or false, and nothing more is known of it."""
        value = _literal(node)
        if isinstance(value, bool):
            return lambda _: value
        term = self._compared(node, {True})
        return lambda values: values[term] is True

    def _compared(self, node: ast.expr, values: set[_Value]) -> str:
        """Note what a term is compared with, and return its name."""
        term = self._source(node)
        self.values.setdefault(term, set()).update(values)
        called = node.func if isinstance(node, ast.Call) else None
        name = getattr(called, "id", getattr(called, "attr", ""))
        self.bounds[term] = (0 if name in _NOT_NEGATIVE else -math.inf, math.inf)
        return term

    def _source(self, node: ast.expr) -> str:
        return self._text[node.col_offset : node.end_col_offset].decode()


def _literal(node: ast.expr) -> _Value | None:
    match node:
        case ast.Constant(value=(bool() | int() | float() | str()) as value):
            return value
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=(int() | float()) as value)):
            return -value
    return None


def _is_like(one: _Value | None, other: _Value) -> bool:
    """Return whether two values are both texts, both truths or both numbers."""
    kinds = [next((k for k in (bool, str) if isinstance(each, k)), float) for each in (one, other)]
    return one is not None and kinds[0] is kinds[1]


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

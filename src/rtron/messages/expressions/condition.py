"""Conditions: boolean combinations of eflow bits, of which some may be unknown.

The language is the part of CEL (cel.dev) that combines names: `!`, `&&`, `||`, parentheses, `true`
and `false`, with CEL's precedence and its logic of three values (Kleene): `false && unknown` is
false, `true || unknown` true. It needs no CEL library, so that rules about presence and silence
work on any robot.
"""

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from rtron.errors import InputError, suggestion

MAX_CONDITION = 1 << 12
"""The longest condition accepted, in characters."""
MAX_DEPTH = 32
"""How deep parentheses and negations may be nested."""

Bits = Mapping[str, bool]
_Holds = Callable[[Bits], "bool | None"]
_TOKEN = re.compile(r"\s*(?:(&&|\|\||[!()])|([A-Za-z_]\w*)|(\S))", re.ASCII)
_CONSTANTS = {"true": True, "false": False}


class Condition:
    """A condition over the bits that are called `names`; InputError if `text` is none."""

    __slots__ = ("_holds", "names", "text")

    def __init__(self, text: str, names: Collection[str]) -> None:
        parsed = _BitConditionParser(text, names).parse()
        self.text = text
        self.names = parsed.names
        """The bits that it depends on."""
        self._holds = parsed.holds

    def holds(self, bits: Bits) -> bool | None:
        """Return whether it holds; None if that hangs on bits that `bits` leaves out."""
        return self._holds(bits)


@dataclass(frozen=True, slots=True)
class _Term:
    """A part of a condition; `constant` is its value if that depends on no bit."""

    holds: _Holds
    names: frozenset[str] = frozenset()
    constant: bool | None = None


class _BitConditionParser:
    """Recursive descent: or, and, not, and what stands alone."""

    def __init__(self, text: str, names: Collection[str]) -> None:
        if len(text) > MAX_CONDITION:
            raise InputError(f"a condition is longer than {MAX_CONDITION} characters")
        self._names = names
        self._tokens = [
            (match[match.lastindex], match.start(match.lastindex) + 1)
            for match in _TOKEN.finditer(text)
            if match.lastindex
        ]
        self._tokens.append(("", len(text) + 1))
        self._position = 0
        self._depth = 0

    def parse(self) -> _Term:
        """Return the whole condition."""
        part = self._or_term()
        if self._next():
            raise self._unexpected()
        return part

    def _next(self) -> str:
        return self._tokens[self._position][0]

    def _take(self, token: str) -> bool:
        taken = self._next() == token
        self._position += taken
        return taken

    def _or_term(self) -> _Term:
        parts = [self._and_term()]
        while self._take("||"):
            parts.append(self._and_term())
        return _joined(parts, decisive=True)

    def _and_term(self) -> _Term:
        parts = [self._unary_term()]
        while self._take("&&"):
            parts.append(self._unary_term())
        return _joined(parts, decisive=False)

    def _unary_term(self) -> _Term:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise InputError(f"a condition is nested deeper than {MAX_DEPTH}")
        if self._take("!"):
            part = _negated(self._unary_term())
        elif self._take("("):
            part = self._or_term()
            if not self._take(")"):
                raise self._unexpected()
        else:
            part = self._bit_term()
        self._depth -= 1
        return part

    def _bit_term(self) -> _Term:
        word = self._next()
        if word in _CONSTANTS:
            part = _constant(_CONSTANTS[word])
        elif word in self._names:
            part = _Term(lambda bits: bits.get(word), frozenset({word}))
        else:
            raise self._unexpected()
        self._position += 1
        return part

    def _unexpected(self) -> InputError:
        token, column = self._tokens[self._position]
        location = f"column {column} of the condition"
        if not token.isidentifier():
            return InputError(
                f"{location}: {token!r} is not expected"
                if token
                else f"{location}: it ends too early",
                help="combine eflows with && || ! and parentheses",
            )
        help = suggestion(token, self._names)
        return InputError(f"{location}: there is no eflow {token[:80]}", help=help)


def _constant(value: bool) -> _Term:  # noqa: FBT001
    return _Term(lambda bits: value, constant=value)


def _negated(part: _Term) -> _Term:
    if part.constant is not None:
        return _constant(not part.constant)
    holds = part.holds

    def negation(bits: Bits) -> bool | None:
        value = holds(bits)
        return None if value is None else not value

    return _Term(negation, part.names)


def _joined(parts: list[_Term], *, decisive: bool) -> _Term:
    """Join parts by `||`, for which true is decisive, or by `&&`, for which false is."""
    if any(part.constant is decisive for part in parts):
        return _constant(decisive)
    open_parts = [part for part in parts if part.constant is None]
    if not open_parts:
        return _constant(not decisive)
    if len(open_parts) == 1:
        return open_parts[0]
    return _Term(
        _junction(tuple(part.holds for part in open_parts), decisive=decisive),
        frozenset().union(*(part.names for part in open_parts)),
    )


def _junction(parts: tuple[_Holds, ...], *, decisive: bool) -> _Holds:
    def junction(bits: Bits) -> bool | None:
        found: bool | None = not decisive
        for part in parts:
            value = part(bits)
            if value is decisive:
                return decisive
            if value is None:
                found = None
        return found

    return junction

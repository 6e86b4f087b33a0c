"""Conditions: boolean combinations of eflow bits, of which some may be unknown.

The language is the part of CEL (cel.dev) that combines names: `!`, `&&`, `||`, parentheses, `true`
and `false`, with CEL's precedence and its logic of three values (Kleene): `false && unknown` is
false, `true || unknown` true. It needs no CEL library, so that rules about presence and silence
work on any robot.
"""

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from rtron.errors import InputError

MAX_CONDITION = 1 << 12
"""The longest condition accepted, in characters."""
MAX_DEPTH = 32
"""How deep parentheses and negations may be nested."""

Bits = Mapping[str, bool]
_Node = Callable[[Bits], "bool | None"]
_TOKEN = re.compile(r"\s*(?:(&&|\|\||[!()])|([A-Za-z_]\w*)|(\S))", re.ASCII)
_CONSTANTS = {"true": True, "false": False}


class Condition:
    """A condition over the bits that are called `names`; InputError if `text` is none."""

    __slots__ = ("_holds", "names", "text")

    def __init__(self, text: str, names: Collection[str]) -> None:
        parsed = _Parser(text, names).parse()
        self.text = text
        self.names = parsed.names
        """The bits that it depends on."""
        self._holds = parsed.holds

    def holds(self, bits: Bits) -> bool | None:
        """Return whether it holds; None if that hangs on bits that `bits` leaves out."""
        return self._holds(bits)


@dataclass(frozen=True, slots=True)
class _Part:
    """A part of a condition; `fixed` is its value if that depends on no bit."""

    holds: _Node
    names: frozenset[str] = frozenset()
    fixed: bool | None = None


class _Parser:
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
        self._at = 0
        self._depth = 0

    def parse(self) -> _Part:
        """Return the whole condition."""
        part = self._either()
        if self._next():
            raise self._unexpected()
        return part

    def _next(self) -> str:
        return self._tokens[self._at][0]

    def _take(self, token: str) -> bool:
        taken = self._next() == token
        self._at += taken
        return taken

    def _either(self) -> _Part:
        parts = [self._both()]
        while self._take("||"):
            parts.append(self._both())
        return _joined(parts, decisive=True)

    def _both(self) -> _Part:
        parts = [self._single()]
        while self._take("&&"):
            parts.append(self._single())
        return _joined(parts, decisive=False)

    def _single(self) -> _Part:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise InputError(f"a condition is nested deeper than {MAX_DEPTH}")
        if self._take("!"):
            part = _negated(self._single())
        elif self._take("("):
            part = self._either()
            if not self._take(")"):
                raise self._unexpected()
        else:
            part = self._word()
        self._depth -= 1
        return part

    def _word(self) -> _Part:
        word = self._next()
        if word in _CONSTANTS:
            part = _constant(_CONSTANTS[word])
        elif word in self._names:
            part = _Part(lambda bits: bits.get(word), frozenset({word}))
        else:
            raise self._unexpected()
        self._at += 1
        return part

    def _unexpected(self) -> InputError:
        word, column = self._tokens[self._at]
        place = f"column {column} of the condition"
        if not word.isidentifier():
            return InputError(
                f"{place}: {word!r} is not expected" if word else f"{place}: it ends too early",
                help="combine eflows with && || ! and parentheses",
            )
        near = get_close_matches(word, self._names, n=1)
        known = f"did you mean {near[0]}?" if near else f"there are: {', '.join(self._names)}"
        return InputError(f"{place}: there is no eflow {word[:80]}", help=known)


def _constant(value: bool) -> _Part:  # noqa: FBT001
    return _Part(lambda bits: value, fixed=value)


def _negated(part: _Part) -> _Part:
    if part.fixed is not None:
        return _constant(not part.fixed)
    holds = part.holds

    def negation(bits: Bits) -> bool | None:
        value = holds(bits)
        return None if value is None else not value

    return _Part(negation, part.names)


def _joined(parts: list[_Part], *, decisive: bool) -> _Part:
    """Join parts by `||`, for which true is decisive, or by `&&`, for which false is."""
    if any(part.fixed is decisive for part in parts):
        return _constant(decisive)
    open_parts = [part for part in parts if part.fixed is None]
    if not open_parts:
        return _constant(not decisive)
    if len(open_parts) == 1:
        return open_parts[0]
    return _Part(
        _junction(tuple(part.holds for part in open_parts), decisive=decisive),
        frozenset().union(*(part.names for part in open_parts)),
    )


def _junction(parts: tuple[_Node, ...], *, decisive: bool) -> _Node:
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

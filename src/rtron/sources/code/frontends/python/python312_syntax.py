"""Syntax of Python 3.12 rewritten for an older parser; no line moves.

An f-string may hold its own quotes between braces (PEP 701): it becomes one of three quotes each.
Type parameters and `type X = ...` go (PEP 695): what they say is no value.
"""

import re
from collections.abc import Iterator

from rtron.sources.code.frontends.python.python2_syntax import Edit, apply_edits
from rtron.sources.code.frontends.python.tokenizer import Token, bracket_depth_after, statements

_STRING_START = re.compile(r"(?i)(?<!\w)([ubrft]{0,3})(\"\"\"|'''|\"|')")
_OPENING, _CLOSING = "([{", ")]}"
_OTHER = {"'": '"', '"': "'"}
_MAX_DEPTH = 8
_MAX_FIELD = 2000
"""The longest text between the braces of an f-string, characters."""
_MAX_UNCLOSED = 50
"""After so many f-strings that are not closed nothing is rewritten any more."""
_UNCLOSED = -1


def as_python311(text: str) -> str:
    """Return Python 3.12 text as Python 3.11 of the same meaning; what is older stays."""
    plain = apply_edits(text, _FStrings(text).edits())
    edits = (edit for tokens in statements(plain) for edit in _type_edits(tokens))
    return apply_edits(plain, edits)


def _type_edits(tokens: list[Token]) -> Iterator[Edit]:
    words = [token.text for token in tokens[:4]]
    at = 1 if words[:1] == ["async"] else 0
    if words[at : at + 1] in (["def"], ["class"]) and words[at + 2 : at + 3] == ["["]:
        yield Edit(tokens[at + 2].start, _closing(tokens, at + 2).end, "")
    elif words[:1] == ["type"] and len(tokens) > 1 and tokens[1].kind == "name":
        yield Edit(tokens[0].start, tokens[1].start, "")
        if words[2:3] == ["["]:
            yield Edit(tokens[2].start, _closing(tokens, 2).end, "")


def _closing(tokens: list[Token], index: int) -> Token:
    depth = 0
    for token in tokens[index:]:
        depth = bracket_depth_after(token, depth)
        if not depth:
            return token
    return tokens[-1]


class _FStrings:
    """Finds the f-strings of a text as Python 3.12 does, and those that need other quotes."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._edits: list[Edit] = []
        self._boundaries: dict[int, int] = {}
        self._unclosed = 0

    def edits(self) -> list[Edit]:
        """Return the edits of the whole text."""
        at = 0
        while at < len(self._text):
            at = self._skip(at, 0)
        return self._edits

    def _skip(self, at: int, depth: int) -> int:
        """Return where what begins at `at` ends: a comment, a string or one character."""
        if self._text[at] == "#":
            end = self._text.find("\n", at)
            return end if end >= 0 else len(self._text)
        match = _STRING_START.match(self._text, at)
        if match is None:
            return at + 1
        is_formatted = "f" in match[1].lower() or "t" in match[1].lower()
        if not is_formatted or depth == _MAX_DEPTH or self._unclosed >= _MAX_UNCLOSED:
            return self._skip_plain(match.end(), match[2])
        begin = match.start(2)
        if begin not in self._boundaries:
            self._boundaries[begin] = self._skip_formatted(begin, match[2], depth)
        return self._boundaries[begin]

    def _skip_plain(self, at: int, quote: str) -> int:
        """Return where a string ends; one that is not closed ends with its line."""
        while at < len(self._text) and not self._text.startswith(quote, at):
            if len(quote) == 1 and self._text[at] == "\n":
                return at
            at += 2 if self._text[at] == "\\" else 1
        return at + len(quote)

    def _skip_formatted(self, begin: int, quote: str, depth: int) -> int:
        """Return where an f-string ends; one that is none by these rules is a plain string."""
        at, has_quotes = begin + len(quote), False
        while not self._text.startswith(quote, at):
            before, at = at, self._skip_part(at, quote, depth)
            if at == _UNCLOSED:
                self._unclosed += 1
                return self._skip_plain(begin + len(quote), quote)
            has_quotes |= self._text[before] == "{" and quote in self._text[before:at]
        if has_quotes and len(quote) == 1:
            new = 3 * (quote if depth % 2 == 0 else _OTHER[quote])
            self._edits += [Edit(begin, begin + 1, new), Edit(at, at + 1, new)]
        return at + len(quote)

    def _skip_part(self, at: int, quote: str, depth: int) -> int:
        """Return where a field, an escape or a character of an f-string ends."""
        if at >= len(self._text) or (len(quote) == 1 and self._text[at] == "\n"):
            return _UNCLOSED
        is_escape = self._text[at] == "\\" or self._text.startswith("{{", at)
        if is_escape or self._text[at] != "{":
            return at + 1 + is_escape
        return self._skip_field(at + 1, depth)

    def _skip_field(self, at: int, depth: int) -> int:
        """Return where a field's `}` ends; what stands in it is Python, strings and all."""
        brackets, limit = 0, min(len(self._text), at + _MAX_FIELD)
        while at < limit:
            character = self._text[at]
            if character == "}" and not brackets:
                return at + 1
            brackets += (character in _OPENING) - (character in _CLOSING)
            at = self._skip(at, depth + 1)
        return _UNCLOSED

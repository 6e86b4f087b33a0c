"""The tokens and statements of Python 2 and 3 text, found whatever else is wrong with it.

Python's own `tokenize` differs between versions and refuses Python 2; this reader refuses
nothing: an unclosed string ends with its line or the file, an unclosed bracket where a line begins
with a word that cannot stand in brackets (Python reference, lexical analysis).
"""

import re
from collections.abc import Iterator
from typing import NamedTuple

_TOKEN = re.compile(
    r"""
    (?P<blank> [ \t\f]+ | \#[^\n]* | \\\n )
  | (?P<newline> \n )
  | (?P<string> (?i:[ubrf]{0,3}) (?:
        \"\"\" [^"\\]* (?: (?: \\. | "(?!"") ) [^"\\]* )* (?: \"\"\" | \\?\Z )
      | ''' [^'\\]* (?: (?: \\. | '(?!'') ) [^'\\]* )* (?: ''' | \\?\Z )
      | " [^"\\\n]* (?: \\. [^"\\\n]* )* "?
      | ' [^'\\\n]* (?: \\. [^'\\\n]* )* '? ) )
  | (?P<number> \.?\d [\w.]* )
  | (?P<name> [^\W\d]\w* )
  | (?P<operator> <> | != | [-+*/%@&|^=<>:]?= | \*\*=? | //=? | >>=? | <<=? | -> | . )
    """,
    re.VERBOSE | re.DOTALL,
)
_COMPOUND = frozenset(
    {"if", "elif", "else", "while", "for", "try", "except", "finally", "with", "def", "class"}
)
_NEVER_IN_BRACKETS = frozenset(
    {"def", "class", "return", "raise", "while", "with", "try", "except", "import", "pass"}
    | {"break", "continue", "global", "del", "assert"}
)


class Token(NamedTuple):
    """A piece of text, where it begins, and its line, which counts from 1."""

    kind: str
    text: str
    start: int
    line: int

    @property
    def end(self) -> int:
        """Where the text behind it begins."""
        return self.start + len(self.text)

    @property
    def last_line(self) -> int:
        """The line it ends on."""
        return self.line + self.text.count("\n")


def tokenize(text: str) -> Iterator[Token]:
    """Yield all tokens but blanks; line ends are tokens too."""
    line = 1
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup or "operator"
        if kind != "blank":
            yield Token(kind, match[0], match.start(), line)
        if "\n" in match[0]:
            line += match[0].count("\n")


def statements(text: str) -> Iterator[list[Token]]:
    """Yield the tokens of each statement; the head of a compound one ends with its colon."""
    found: list[Token] = []
    depth = lambdas = 0
    starts_line = True
    for token in tokenize(text):
        if starts_line and depth and token.text in _NEVER_IN_BRACKETS:
            yield found
            found, depth, lambdas = [], 0, 0
        starts_line = token.kind == "newline"
        depth = bracket_depth_after(token, depth)
        is_end = starts_line or token.text == ";"
        if not is_end:
            found.append(token)
        if depth or not found:
            continue
        lambdas += token.text == "lambda"
        if is_end or (token.text == ":" and not lambdas and found[0].text in _COMPOUND):
            yield found
            found, lambdas = [], 0
        lambdas -= token.text == ":" and lambdas > 0
    if found:
        yield found


def indentation(text: str, token: Token) -> str:
    """Return the white space before a token that is the first of its line, else nothing."""
    begin = token.start
    while begin and text[begin - 1] in " \t\f":
        begin -= 1
    return text[begin : token.start] if not begin or text[begin - 1] == "\n" else ""


def bracket_depth_after(token: Token, depth: int) -> int:
    """Return how many brackets are open behind a token."""
    if token.text in ("(", "[", "{"):
        return depth + 1
    return max(depth - 1, 0) if token.text in (")", "]", "}") else depth


def top_level_indices(tokens: list[Token], text: str) -> list[int]:
    """Return the indices of an operator or word that stands in no brackets."""
    indices, depth = [], 0
    for index, token in enumerate(tokens):
        depth = bracket_depth_after(token, depth)
        if not depth and token.text == text:
            indices.append(index)
    return indices

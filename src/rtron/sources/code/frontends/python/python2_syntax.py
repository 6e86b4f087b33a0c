"""Python 2 rewritten as Python 3, statement by statement; no line moves.

What changed is listed in "What's New In Python 3.0" and PEPs 3105, 3109, 3110, 3113, 3127.
"""

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from rtron.sources.code.frontends.python.tokenizer import (
    Token,
    bracket_depth_after,
    indentation,
    statements,
    top_level_indices,
)


class Edit(NamedTuple):
    """Text from `start` to `end` is replaced."""

    start: int
    end: int
    text: str


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """Return a text with its edits made; of two that overlap the first counts."""
    pieces, done = [], 0
    for edit in sorted(edits, key=lambda edit: (edit.start, edit.end)):
        if edit.start >= done:
            pieces += [text[done : edit.start], edit.text]
            done = edit.end
    return "".join([*pieces, text[done:]])


TUPLE_PARAMETER = "_tuple_"
_LONG = re.compile(r"(0[xXoObB]\w+|\d+)[lL]")
_OCTAL = re.compile(r"0+([0-7]+)[lL]?")
_RAW_UNICODE = re.compile(r"[uU][rR](?=['\"])")
_NOT_AN_ESCAPE = re.compile(
    r"(?<!\\)((?:\\\\)*)\\(?=u(?![0-9a-fA-F]{4})|U(?!00(?:0[0-9a-fA-F]|10)[0-9a-fA-F]{4})|N(?!\{))"
)
_MAX_TOKENS = 2000
_MAX_LAMBDAS = 20
_CLOSING = frozenset({")", "]", "}", ",", ";", "for"})


def as_python3(text: str) -> str:
    """Return Python 2 text as Python 3 of the same meaning, as far as that is a matter of syntax.

    A parameter `(a, b)` of a function becomes one whose name begins with `TUPLE_PARAMETER` and
    whose annotation is the tuple. What is already Python 3 stays.
    """
    return apply_edits(text, (e for tokens in statements(text) for e in _edits(text, tokens)))


def _edits(text: str, tokens: list[Token]) -> Iterator[Edit]:
    yield from _indentation(text, tokens[0])
    yield from _token_edits(tokens)
    yield from _lambda_edits(text, tokens)
    if tokens[0].text == "def":
        yield from _def_edits(text, tokens)
    elif tokens[0].text == "print":
        yield from _print_edits(text, tokens)
    elif tokens[0].text == "exec":
        yield from _exec_edits(tokens)
    elif tokens[0].text == "except":
        yield from _except_edits(tokens)
    elif tokens[0].text == "raise":
        yield from _raise_edits(tokens)


def _indentation(text: str, first: Token) -> Iterator[Edit]:
    """Replace tabs: each leads to the next multiple of eight."""
    white = indentation(text, first)
    if "\t" in white:
        yield Edit(first.start - len(white), first.start, white.expandtabs(8))


def _token_edits(tokens: list[Token]) -> Iterator[Edit]:
    quoted = False
    for token, behind in zip(tokens, [*tokens[1:], tokens[-1]], strict=True):
        new = _python3_token(token, behind)
        if token.text == "`":
            quoted = not quoted
            new = "repr(" if quoted else ")"
        if new != token.text:
            yield Edit(token.start, token.end, new)


def _python3_token(token: Token, behind: Token) -> str:
    """Return a token as Python 3 spells it; `async` was a name of any kind."""
    if token.kind == "number":
        return _number(token.text)
    if token.kind == "string":
        return _string(token.text)
    if token.text == "async" and behind.text not in ("def", "for", "with"):
        return "async_"
    return "!=" if token.text == "<>" else token.text


def _number(text: str) -> str:
    if octal := _OCTAL.fullmatch(text):
        return f"0o{octal[1]}"
    return found[1] if (found := _LONG.fullmatch(text)) else text


def _string(text: str) -> str:
    """Drop the `u` of a raw Unicode string; elsewhere keep what only looks like an escape."""
    if "r" in text[: len(text) - len(text.lstrip("uUrRbBfF"))].lower():
        return _RAW_UNICODE.sub("r", text, count=1)
    return _NOT_AN_ESCAPE.sub(r"\1\\\\", text)


def _print_edits(text: str, tokens: list[Token]) -> Iterator[Edit]:
    keyword, *rest = tokens
    if rest and (rest[0].text in (".", "=") or _is_parenthesised(rest)):
        return
    if rest and rest[0].text == ">>":
        yield from _print_file_edits(text, keyword, rest)
        return
    yield Edit(keyword.start, keyword.end, "print(" if rest else "print()")
    if rest:
        yield Edit(tokens[-1].end, tokens[-1].end, ")")


def _print_file_edits(text: str, keyword: Token, rest: list[Token]) -> Iterator[Edit]:
    """`print >>file, values`: the file goes behind the values, its line ends stay."""
    commas = top_level_indices(rest, ",")
    end = rest[commas[0]].end if commas else rest[-1].end
    file = text[rest[0].end : rest[commas[0]].start if commas else end]
    comma = ", " if end < rest[-1].end and rest[-1].text != "," else ""
    yield Edit(keyword.start, end, "print(" + "\n" * text.count("\n", keyword.start, end))
    yield Edit(rest[-1].end, rest[-1].end, f"{comma}file={' '.join(file.split())})")


def _exec_edits(tokens: list[Token]) -> Iterator[Edit]:
    keyword, *rest = tokens
    if not rest or _is_parenthesised(rest):
        return
    yield Edit(keyword.start, keyword.end, "exec(")
    for index in top_level_indices(rest, "in")[:1]:
        yield Edit(rest[index].start, rest[index].end, ",")
    yield Edit(rest[-1].end, rest[-1].end, ")")


def _is_parenthesised(tokens: list[Token]) -> bool:
    """Whether all of it stands in one pair of round brackets."""
    return tokens[0].text == "(" and _closing_index(tokens, 0) == len(tokens) - 1


def _except_edits(tokens: list[Token]) -> Iterator[Edit]:
    """`except E, e:`; a variable that is no plain name cannot be kept."""
    for index in top_level_indices(tokens, ",")[:1]:
        comma, behind = tokens[index], tokens[index + 1 : -1]
        if len(behind) == 1 and behind[0].kind == "name":
            space = " " if comma.end == behind[0].start else ""
            yield Edit(comma.start, comma.end, f" as{space}")
        elif tokens[-1].text == ":":
            yield Edit(comma.start, tokens[-1].start, "")


def _raise_edits(tokens: list[Token]) -> Iterator[Edit]:
    """`raise E, value, traceback`: the traceback becomes an argument too."""
    for index in top_level_indices(tokens, ",")[:1]:
        yield Edit(tokens[index].start, tokens[index].end, "(")
        yield Edit(tokens[-1].end, tokens[-1].end, ")")


def _def_edits(text: str, tokens: list[Token]) -> Iterator[Edit]:
    opening = next((index for index, token in enumerate(tokens) if token.text == "("), None)
    for begin, end in _tuple_parameters(tokens, opening) if opening is not None else ():
        start, stop = tokens[begin].start, tokens[end].end
        if _has_no_comma(tokens[begin:end]):
            yield Edit(start, stop, text[start + 1 : stop - 1])
        else:
            yield Edit(start, stop, f"{TUPLE_PARAMETER}{start}: {text[start:stop]}")


def _lambda_edits(text: str, tokens: list[Token]) -> Iterator[Edit]:
    """Take tuples among the parameters of lambdas apart, in a statement of a human's making."""
    if len(tokens) > _MAX_TOKENS:
        return
    indices = [index for index, token in enumerate(tokens) if token.text == "lambda"]
    for index in indices[:_MAX_LAMBDAS]:
        if pairs := _tuple_parameters(tokens, index):
            yield from _one_lambda_edits(text, tokens, pairs)


def _one_lambda_edits(
    text: str, tokens: list[Token], pairs: list[tuple[int, int]]
) -> Iterator[Edit]:
    """`lambda (a, b): e` is `lambda t: (lambda a, b: (e))(*t)`."""
    inner, given = [], []
    for begin, end in pairs:
        start, stop = tokens[begin].start, tokens[end].end
        single = _has_no_comma(tokens[begin:end])
        name = text[start + 1 : stop - 1] if single else f"{TUPLE_PARAMETER}{start}"
        yield Edit(start, stop, name)
        if not single:
            inner.append(" ".join(text[start + 1 : stop - 1].rstrip(", ").split()))
            given.append(f"*{name}")
    colon = next((i for i in range(pairs[-1][1], len(tokens)) if tokens[i].text == ":"), None)
    if inner and colon is not None:
        end = _end_of_body(tokens, colon + 1)
        yield Edit(tokens[colon].end, tokens[colon].end, f" (lambda {', '.join(inner)}: (")
        yield Edit(end, end, f"))({', '.join(given)})")


def _end_of_body(tokens: list[Token], index: int) -> int:
    """Return where the body of a lambda ends that begins at `index`."""
    depth = 0
    for before, token in zip(tokens[index - 1 :], tokens[index:], strict=False):
        if not depth and token.text in _CLOSING:
            return before.end
        depth = bracket_depth_after(token, depth)
    return tokens[-1].end


def _tuple_parameters(tokens: list[Token], index: int) -> list[tuple[int, int]]:
    """Return where each bracketed parameter begins and ends, behind a `lambda` or a `(`."""
    found, depth = [], 0
    for at in range(index + 1, len(tokens)):
        text = tokens[at].text
        if not depth and text in (")", ":", "]", "}"):
            break
        if not depth and text == "(" and (at == index + 1 or tokens[at - 1].text == ","):
            found.append((at, _closing_index(tokens, at)))
        depth = bracket_depth_after(tokens[at], depth)
    return found


def _closing_index(tokens: list[Token], index: int) -> int:
    """Return the index of the bracket that closes the one at `index`, or the last index."""
    depth = 0
    for at in range(index, len(tokens)):
        depth = bracket_depth_after(tokens[at], depth)
        if not depth:
            return at
    return len(tokens) - 1


def _has_no_comma(tokens: list[Token]) -> bool:
    return not any(token.text == "," for token in tokens)

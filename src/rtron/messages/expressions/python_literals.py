"""The values of literals as CEL writes them; ValueError for what it does not allow.

cel-python's lexer takes more than CEL does: other escapes as they stand, surrogates, `1.`.
"""

import re
from functools import cache
from typing import Any

from rtron.messages.expressions.errors import CheckError

_LIMIT = 1 << 63
_ESCAPED = dict(zip("abfnrtv\\'\"`?", "\a\b\f\n\r\t\v\\'\"`?", strict=True))
_CHARACTER = re.compile(
    r"""[^\\]|\\(?:(?P<plain>[abfnrtv\\'"`?])|[xX](?P<byte>[\da-fA-F]{2})|(?P<octal>[0-3][0-7]{2})"""
    r"""|u(?P<short>[\da-fA-F]{4})|U(?P<long>[\da-fA-F]{8}))""",
    re.DOTALL | re.ASCII,
)
_QUOTED = re.compile(
    r"""[bB]?(?P<raw>[rR]?)(?P<quote>"{3}|'{3}|"|')(?P<text>.*)(?P=quote)""", re.DOTALL
)
_FLOAT = re.compile(r"-?(?:\d*\.\d+(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)", re.ASCII)


def literal_value(kind: str, text: str) -> Any:  # noqa: ANN401 - of the literal's type
    """Return the value of a literal, `kind` being the lexer's name for it."""
    if kind == "BOOL_LIT":
        return text == "true"
    if kind == "INT_LIT":
        return _integer(text)
    if kind == "FLOAT_LIT":
        return _float(text)
    return _bytes(text) if kind == "BYTES_LIT" else _string(text)


def _integer(text: str) -> int:
    value = int(text, 16 if "x" in text else 10)
    if not -_LIMIT <= value < _LIMIT:
        raise ValueError("invalid int literal")
    return value


def _float(text: str) -> float:
    if not _FLOAT.fullmatch(text):
        raise ValueError(f"a digit must follow the point of {text}")
    return float(text)


def _string(text: str) -> str:
    return "".join(
        each if isinstance(each, str) else _code_point(each) for each in _characters(text)
    )


def _bytes(text: str) -> bytes:
    found = bytearray()
    for each in _characters(text):
        if isinstance(each, str):
            found += each.encode()
        elif each["short"] or each["long"]:
            raise ValueError(f"{each[0]} cannot be used in bytes")
        else:
            found.append(_number(each))
    return bytes(found)


def _characters(literal: str) -> list[str | re.Match[str]]:
    """Return the characters between the quotes, those written by their numbers as matches."""
    quoted = _QUOTED.fullmatch(literal)
    if quoted is None or (quoted["raw"] and quoted["quote"] in quoted["text"]):
        raise ValueError(f"{literal} is not one literal")
    if quoted["raw"]:
        return [quoted["text"]]
    found: list[str | re.Match[str]] = []
    at, text = 0, quoted["text"]
    while at < len(text):
        match = _CHARACTER.match(text, at)
        if match is None:
            raise ValueError(f"illegal escape sequence {text[at : at + 2]}")
        found.append(_plain(match) or match)
        at = match.end()
    return found


def _plain(match: re.Match[str]) -> str | None:
    return _ESCAPED[match["plain"]] if match["plain"] else match[0] if len(match[0]) == 1 else None


def _code_point(match: re.Match[str]) -> str:
    number = _number(match)
    if number > 0x10FFFF or 0xD800 <= number <= 0xDFFF:  # noqa: PLR2004 - Unicode's
        raise ValueError(f"illegal escape sequence {match[0]}: no character of Unicode")
    return chr(number)


def _number(match: re.Match[str]) -> int:
    if match["octal"]:
        return int(match["octal"], 8)
    return int(match["byte"] or match["short"] or match["long"], 16)


_WRAPPERS = frozenset(
    {"expr", "conditionalor", "conditionaland", "relation", "addition", "multiplication"}
    | {"unary", "member", "primary", "paren_expr"}
)


def unwrapped(node: Any) -> Any:  # noqa: ANN401 - a tree
    """Return a part without its brackets, and what else only passes it on."""
    while getattr(node, "data", "") in _WRAPPERS and len(node.children) == 1:
        node = node.children[0]
    return node


def bracket_count(node: Any) -> int:  # noqa: ANN401 - a tree
    """Return how many pairs of brackets are around a part."""
    count = 0
    while getattr(node, "data", "") in _WRAPPERS and len(node.children) == 1:
        count += node.data == "paren_expr"
        node = node.children[0]
    return count


def argument_nodes(rest: tuple[Any, ...]) -> list[Any]:
    """Return what stands between the commas; `rest` is empty where nothing does."""
    return list(rest[0].children) if rest else []


def variable_name(node: Any) -> str:  # noqa: ANN401
    """Return the name that a part is, empty if it is something else."""
    found = unwrapped(node)
    return str(found.children[0]) if found.data == "ident" else ""


@cache
def _parser() -> Any:  # noqa: ANN401 - celpy's
    from celpy.celparser import CELParser  # noqa: PLC0415 - where it is needed only

    return CELParser()


def parse(text: str) -> Any:  # noqa: ANN401 - lark's
    """Return the tree of an expression; CheckError if it is none."""
    from celpy.celparser import CELParseError  # noqa: PLC0415 - as above

    try:
        return _parser().parse(text)
    except CELParseError as error:
        line, column = error.line or 1, error.column or 1
        raise CheckError(f"ERROR: <input>:{line}:{column}: Syntax error") from error

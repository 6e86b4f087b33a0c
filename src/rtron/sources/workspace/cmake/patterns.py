"""CMake's regular expressions, the plain ones: a stranger's real one could run for ever.

A plain one is made of characters, `.`, `.*` and escaped characters, with `^` and `$` at its to_end.
"""

import re
from fnmatch import translate
from functools import lru_cache

from rtron.sources.workspace.cmake.command_call import MAX_LENGTH

_TOKEN = re.compile(r"\.\*|\\(?P<escaped>[^\w\s])|(?P<any>\.)|(?P<plain>[\w /=:,@%&~!<>'\"-])")
_ENDING = r"\.[^.]*"
_MAX_LENGTH = 200


@lru_cache(maxsize=1024)
def plain_pattern(pattern: str) -> re.Pattern[str] | None:
    """Return what matches the texts in which CMake finds a pattern; None if it is not plain."""
    from_start, to_end = pattern.startswith("^"), _has_end_anchor(pattern)
    glob = _as_glob(pattern[from_start : len(pattern) - to_end])
    if glob is None:
        return None
    return re.compile(translate(f"{'' if from_start else '*'}{glob}{'' if to_end else '*'}"))


def replace_plain(text: str, pattern: str, new: str) -> str | None:
    """Return a text with what matches replaced; None where the pattern is not literal."""
    from_start, to_end = pattern.startswith("^"), _has_end_anchor(pattern)
    inner = pattern[from_start : len(pattern) - to_end]
    if to_end and inner == _ENDING and "\\" not in new:
        head, dot, _ = text.rpartition(".")
        return head + new if dot else text
    literal = _as_literal(inner)
    if not literal or "\\" in new or text.count(literal) * len(new) > MAX_LENGTH:
        return None
    if not (from_start or to_end):
        return text.replace(literal, new)
    found = text == literal if from_start and to_end else _stands_at(text, literal, at_end=to_end)
    if not found:
        return text
    return text[: -len(literal)] + new if to_end else new + text[len(literal) :]


def _stands_at(text: str, literal: str, *, at_end: bool) -> bool:
    return text.endswith(literal) if at_end else text.startswith(literal)


def _has_end_anchor(pattern: str) -> bool:
    return pattern.endswith("$") and not pattern.endswith("\\$")


def _tokens(pattern: str) -> list[re.Match[str]] | None:
    found = list(_TOKEN.finditer(pattern))
    is_plain = sum(len(match[0]) for match in found) == len(pattern) <= _MAX_LENGTH
    return found if is_plain else None


def _as_glob(pattern: str) -> str | None:
    tokens = _tokens(pattern)
    if tokens is None:
        return None
    return "".join(_glob_of(token) for token in tokens)


def _glob_of(token: re.Match[str]) -> str:
    if token[0] == ".*":
        return "*"
    if token["any"]:
        return "?"
    character = token["escaped"] or token[0]
    return f"[{character}]" if character in "*?[" else character


def _as_literal(pattern: str) -> str | None:
    tokens = _tokens(pattern)
    if tokens is None or any(token["any"] or token[0] == ".*" for token in tokens):
        return None
    return "".join(token["escaped"] or token[0] for token in tokens)

"""Names of repositories, packages and nodes, as words."""

import re
from functools import lru_cache

from rtron.functions.text.tokens import Tokens, tokenize

_MAX_LENGTH = 200
_RUN = re.compile(r"[^\W_]+")
_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z][a-z])|(?<=[a-z])(?=[A-Z])")
_LIBRARY = re.compile(r"^lib(?=[a-z0-9]{3})(?!rar)")
_NUMBERED = re.compile(r"([A-Za-z]{4,})(\d\w*)")


@lru_cache(maxsize=2**14)
def name_tokens(name: str) -> Tokens:
    """Return a name's words: parted at signs, at camel humps, and at a number after a word.

    The letters before a number are a word if there are four or more: `turtlebot3`, but not `tf2`.
    A leading `lib` is no word.
    """
    humps = (hump for run in _RUN.findall(name[:_MAX_LENGTH]) for hump in _CAMEL.split(run))
    return tokenize(word for hump in humps for word in split_number(hump))


def split_number(word: str) -> list[str]:
    """Return a word as one word, or as the word and the number that it ends in."""
    numbered = _NUMBERED.fullmatch(word)
    parts = numbered.groups() if numbered else (word,)
    return [_LIBRARY.sub("", part) for part in parts]

"""Names that a stranger chose, made safe to print on a terminal."""

import unicodedata

_SEPARATORS = frozenset({"Zl", "Zp"})


def sanitize(text: str) -> str:
    r"""Return `text` on one line, with every character that could steer a terminal as `\x1b`."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(_escaped(character) if _steers(character) else character for character in text)


def _steers(character: str) -> bool:
    category = unicodedata.category(character)
    return category.startswith("C") or category in _SEPARATORS


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")

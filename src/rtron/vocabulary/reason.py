"""Reasons that people give: what nobody can see is none."""

import unicodedata

_UNSEEN_CATEGORIES = "CMZ"
_BLANK = frozenset("\u115f\u1160\u2800\u3164\uffa0")
"""Letters and symbols without ink: Hangul's fillers, the empty pattern of Braille."""


def visible_text(text: str) -> str:
    """Return a text, or nothing where no character of it can be seen."""
    return text if any(map(_is_visible, text)) else ""


def _is_visible(character: str) -> bool:
    return unicodedata.category(character)[0] not in _UNSEEN_CATEGORIES and character not in _BLANK

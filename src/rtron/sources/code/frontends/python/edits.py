"""Changes of a text, made at once."""

from collections.abc import Iterable
from typing import NamedTuple


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

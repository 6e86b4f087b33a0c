"""Prose, as sentences of words."""

import re
from collections.abc import Iterator
from itertools import islice

from rtron.functions.text.names import split_number
from rtron.functions.text.tokens import Tokens, tokenize

_SENTENCE = re.compile(r"(?<=[.!?;:])\s+|\n\s*\n|\n\s*[-*#+]+\s*|\n\d+[.)]\s+")
_RUN = re.compile(r"[^\W_]+")
_MAX_WORDS = 60


def split_sentences(text: str, limit: int) -> Iterator[Tokens]:
    """Yield the first sentences of a text, list items among them, each cut after 60 words."""
    parts = (part for part in _SENTENCE.split(text) if part.strip())
    for part in islice(parts, limit):
        words = [word for run in _RUN.findall(part) for word in split_number(run)]
        if words:
            yield tokenize(words[:_MAX_WORDS])

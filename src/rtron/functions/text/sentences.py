"""Prose, as sentences of words."""

import re
from collections.abc import Iterator
from itertools import islice

from rtron.functions.text.names import parted
from rtron.functions.text.tokens import Tokens, tokens

_SENTENCE = re.compile(r"(?<=[.!?;:])\s+|\n\s*\n|\n\s*[-*#+]+\s*|\n\d+[.)]\s+")
_RUN = re.compile(r"[^\W_]+")
_LONGEST = 60


def sentences(text: str, most: int) -> Iterator[Tokens]:
    """Yield the first sentences of a text, list items among them, each cut after 60 words."""
    parts = (part for part in _SENTENCE.split(text) if part.strip())
    for part in islice(parts, most):
        words = [word for run in _RUN.findall(part) for word in parted(run)]
        if words:
            yield tokens(words[:_LONGEST])

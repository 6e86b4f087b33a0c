"""Manifests' descriptions: the text between the tags, or nothing where it says nothing."""

import re
from collections.abc import Iterator

from rtron.functions.text.sentences import sentences
from rtron.functions.text.tokens import Tokens

_LONGEST = 4000
_MOST_SENTENCES = 12
_NOISE = re.compile(r"<[^<>]{0,200}>|https?://\S+")
_PLACEHOLDER = re.compile(r"(?:the\s+)?[\w-]+\s+(?:meta-?)?package\.?", re.IGNORECASE)


def description_tokens(description: str) -> Iterator[Tokens]:
    """Yield the sentences of a description; none if it is a placeholder (`The foo package`)."""
    text = _NOISE.sub(" ", description[:_LONGEST]).strip()
    if not _PLACEHOLDER.fullmatch(text):
        yield from sentences(text, _MOST_SENTENCES)

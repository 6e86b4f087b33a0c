"""Manifests' descriptions: the text between the tags, or nothing where it says nothing."""

import re
from collections.abc import Iterator

from rtron.functions.text.prose import split_sentences
from rtron.functions.text.tokens import Tokens

_MAX_CHARACTERS = 4000
_MAX_SENTENCES = 12
_NOISE = re.compile(r"<[^<>]{0,200}>|https?://\S+")
_PLACEHOLDER = re.compile(r"(?:the\s+)?[\w-]+\s+(?:meta-?)?package\.?", re.IGNORECASE)


def description_tokens(description: str) -> Iterator[Tokens]:
    """Yield the sentences of a description; none if it is a placeholder (`The foo package`)."""
    text = _NOISE.sub(" ", description[:_MAX_CHARACTERS]).strip()
    if not _PLACEHOLDER.fullmatch(text):
        yield from split_sentences(text, _MAX_SENTENCES)

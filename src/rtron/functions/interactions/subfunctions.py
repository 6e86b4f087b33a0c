"""What a Recognition package recognises, where that is known (paper 3.2, footnote)."""

import re
from collections.abc import Collection
from functools import cache

from rtron.functions.package_data import load_package_yaml
from rtron.vocabulary import RecognitionSubfunction

_WORD = re.compile(r"[a-z0-9]+")


def subfunction_of(
    name: str, description: str = "", subscribes: Collection[str] = ()
) -> RecognitionSubfunction | None:
    """Return the subfunction that a package's name tells, its description or what it subscribes."""
    for text in (name, description):
        words = frozenset(_WORD.findall(text.lower()))
        by_word = next((sub for sub, keywords, _ in _table() if words & keywords), None)
        if by_word:
            return by_word
    subscribed = frozenset(subscribes)
    return next((sub for sub, _, types in _table() if subscribed & types), None)


@cache
def _table() -> tuple[tuple[RecognitionSubfunction, frozenset[str], frozenset[str]], ...]:
    entries = load_package_yaml("rtron.functions.interactions", "interactions.yaml")["subfunctions"]
    return tuple(
        (RecognitionSubfunction(e["name"]), frozenset(e["words"]), frozenset(e["subscribes"]))
        for e in entries
    )

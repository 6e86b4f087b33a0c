"""The glossary explains each word of a plan's closed sets once, in one sentence each."""

import re
from pathlib import Path

import pytest

from rtron.vocabulary import CoordinationKind, Decision, Domain, Mode, RiskKind, Sharing, StreamKind

PAGE = Path(__file__).parent.parent / "docs" / "glossary.md"
TEXT = PAGE.read_text(encoding="utf-8")
ENTRIES = re.findall(r"^- \*\*([^*]+)\*\*: (.+(?:\n  .+)*)$", TEXT, re.MULTILINE)
CLOSED_SETS = (CoordinationKind, Decision, Domain, Mode, RiskKind, Sharing, StreamKind)


def test_every_line_is_an_entry_of_another_word():
    assert len(re.findall(r"^- ", TEXT, re.MULTILINE)) == len(ENTRIES)
    assert len({word for word, _ in ENTRIES}) == len(ENTRIES)


@pytest.mark.parametrize("words", CLOSED_SETS, ids=lambda words: words.__name__)
def test_every_word_of_a_closed_set_stands_there(words):
    assert [word for word in words if not re.search(rf"\b{word}\b", TEXT)] == []


@pytest.mark.parametrize(("word", "sentence"), ENTRIES, ids=[word for word, _ in ENTRIES])
def test_it_is_one_sentence(word, sentence):
    assert sentence.endswith(".")
    assert not re.search(r"[.!?] [A-Z]", sentence)

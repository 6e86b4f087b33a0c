"""The glossary lists what the vocabulary has: nothing more, nothing less, one sentence each."""

import re
from pathlib import Path
from types import ModuleType

import pytest

from rtron import vocabulary

PAGE = Path(__file__).parent.parent / "docs" / "glossary.md"
TEXT = PAGE.read_text(encoding="utf-8")
ENTRIES = re.findall(r"^- \*\*(\w+)\*\*: (.+(?:\n  .+)*)$", TEXT, re.MULTILINE)


def test_every_public_name_stands_there_once():
    assert sorted(name for name, _ in ENTRIES) == sorted(
        name
        for name, value in vars(vocabulary).items()
        if not (name.startswith("_") or isinstance(value, ModuleType))
    )


def test_every_line_is_an_entry():
    assert len(re.findall(r"^- ", TEXT, re.MULTILINE)) == len(ENTRIES)


@pytest.mark.parametrize(("name", "sentence"), ENTRIES, ids=[name for name, _ in ENTRIES])
def test_it_is_one_sentence(name, sentence):
    assert sentence.endswith(".")
    assert not re.search(r"[.!?] [A-Z]", sentence)

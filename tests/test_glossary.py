"""The glossary lists the types of the vocabulary: nothing more, nothing less, one sentence each."""

import re
from pathlib import Path
import pytest

from rtron import vocabulary

PAGE = Path(__file__).parent.parent / "docs" / "glossary.md"
TEXT = PAGE.read_text(encoding="utf-8")
ENTRIES = re.findall(r"^- \*\*(\w+)\*\*: (.+(?:\n  .+)*)$", TEXT, re.MULTILINE)


def is_type(name):
    """Return whether a name of the vocabulary is a type or an alias of one."""
    value = getattr(vocabulary, name)
    return isinstance(value, type) or not (name.islower() or name.isupper())


def test_every_public_type_stands_there_once():
    public = [name for name in vars(vocabulary) if not name.startswith("_")]
    assert sorted(name for name, _ in ENTRIES) == sorted(filter(is_type, public))


def test_every_line_is_an_entry():
    assert len(re.findall(r"^- ", TEXT, re.MULTILINE)) == len(ENTRIES)


@pytest.mark.parametrize(("name", "sentence"), ENTRIES, ids=[name for name, _ in ENTRIES])
def test_it_is_one_sentence(name, sentence):
    assert sentence.endswith(".")
    assert not re.search(r"[.!?] [A-Z]", sentence)

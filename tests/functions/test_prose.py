"""What of a manifest and a README tells what a package is for."""

import pytest

from rtron.functions import text as prose
from rtron.functions.text import clean_readme, description_tokens, readme_tokens


def words_of(parts):
    return [" ".join(part.words) for part in parts]


@pytest.mark.parametrize(
    "placeholder",
    ["The foo package", "the foo_bar package.", "foo metapackage", "The foo meta-package", "", " "],
)
def test_a_placeholder_says_nothing(placeholder):
    assert words_of(description_tokens(placeholder)) == []


def test_a_description_loses_its_tags_and_addresses():
    text = "<p>Drives <b>wheels</b>.</p> See http://example.org/camera for more."
    assert words_of(description_tokens(text)) == ["drives wheels", "see for more"]


def test_a_description_is_bounded():
    assert len(list(description_tokens("A word. " * 100))) == 12
    assert list(description_tokens("<" * 100_000)) == []


README = """# Rover
[![Build Status](badge.svg)](http://example.org)
Drives a rover. See [the manual](http://example.org/lidar).

## Installation
Needs a camera driver.
### Deeper
Still the camera.

## Nodes
Plans paths with `code_here`.
```
camera camera
```
    $ sudo apt install camera
sudo apt-get install camera

License
-------
A camera licence.

Usage
=====
Runs the rover.
"""


def test_a_readme_keeps_what_tells():
    text = clean_readme(README)
    assert "camera" not in text
    assert "example.org" not in text
    assert "code_here" not in text
    for kept in ("Rover", "Drives a rover", "the manual", "Plans paths", "Runs the rover"):
        assert kept in text


def test_a_readme_is_bounded():
    assert len(list(readme_tokens("A word.\n\n" * 1000))) == 30
    assert len(clean_readme("a " * 50_000)) <= 20_000


class RecordingPattern:
    """A pattern that keeps how many characters it is given."""

    def __init__(self, pattern, searched_texts):
        self.pattern = pattern
        self.looked_at = searched_texts

    def __getattr__(self, name):
        def call(*arguments):
            self.looked_at.append(len(arguments[-1]))
            return getattr(self.pattern, name)(*arguments)

        return call


@pytest.fixture
def searched_texts(monkeypatch):
    """Return how many characters each look of a README's patterns got."""
    found = []
    patterns = [(prose, name) for name in ("_CODE", "_MARKUP", "_HEADING", "_USELESS_LINE")]
    for module, name in (*patterns, (prose, "_SENTENCE"), (prose, "_RUN")):
        monkeypatch.setattr(module, name, RecordingPattern(getattr(module, name), found))
    return found


SIGNS = [
    "`",
    "<",
    "![",
    "](",
    "# ",
    "#a\n",
    "a\n==\n",
    "=\n",
    "\n- ",
    "```",
    "http://",
    "a. ",
    "\n ",
    "a ",
]


@pytest.mark.parametrize("sign", SIGNS)
def test_of_a_hostile_readme_a_bounded_part_is_looked_at(searched_texts, sign):
    words = [len(part.words) for part in readme_tokens(sign * 100_000)]
    assert max(words, default=0) <= 60
    assert len(words) <= 30
    assert len(searched_texts) <= 5 + 30
    assert max(searched_texts) <= 2 * 20_000 + 1  # headings get empty lines around them

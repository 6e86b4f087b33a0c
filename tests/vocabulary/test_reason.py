import pytest

from rtron.vocabulary import visible_text


@pytest.mark.parametrize("text", ["x", " x ", "\u200bx", "火災", "!", "e\u0301", "\u2801"])
def test_what_can_be_seen_is_a_text(text):
    assert visible_text(text) == text


@pytest.mark.parametrize(
    "text",
    ["", " ", "\u200b", "\u00ad\ufeff", "\u3164" * 3, "\u2800 \u115f", "\u0301", "\x07", "\u202e"],
)
def test_what_nobody_can_see_is_none(text):
    assert visible_text(text) == ""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sanitize import sanitize


@pytest.mark.parametrize(
    ("hostile", "harmless"),
    [
        ("/cmd_vel", "/cmd_vel"),
        ("\x1b[31mred", "\\x1b[31mred"),
        ("a\nb\rc\td", "a\\nb\\rc\\td"),
        ("\x9b2J\x7f\0", "\\x9b2J\\x7f\\x00"),
        ("\u202eright to left\u2028", "\\u202eright to left\\u2028"),
        ("\udcff", "\\udcff"),
        ("[bold]ü机[/bold]", "[bold]ü机[/bold]"),
    ],
)
def test_what_steers_a_terminal_is_escaped(hostile, harmless):
    assert sanitize(hostile) == harmless


@given(st.text())
def test_the_result_is_printable_and_stays_as_it_is(text):
    assert all(character.isprintable() or character.isspace() for character in sanitize(text))
    assert "\n" not in sanitize(text)
    assert "\x1b" not in sanitize(text)
    assert sanitize(sanitize(text)) == sanitize(text)

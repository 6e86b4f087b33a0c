"""`rtron.toml`: what it says, and what is wrong with it."""

import pytest

from rtron.errors import InputError
from rtron.sources.ignores import MAX_BYTES, read_config

RULES = ["several_publishers", "no_server"]
ENTRY = '[[ignore]]\nrule = "no_server"\nreason = "optional"\n'


def read(tmp_path, text):
    path = tmp_path / "rtron.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_config(path, RULES)


def test_an_entry_has_a_rule_a_reason_and_its_line(tmp_path):
    text = (
        f'# ours\n{ENTRY}\n[[ignore]]\nrule = "several_publishers"\ntopic = "/cmd_*"\nreason = "x"'
    )
    first, second = read(tmp_path, text)
    assert (first.rule, first.topic, first.reason) == ("no_server", "*", "optional")
    assert (first.place.line, second.place.line, second.topic) == (2, 6, "/cmd_*")
    assert not first.is_comment


def test_an_empty_file_ignores_nothing(tmp_path):
    assert read(tmp_path, "") == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[ignore]", "not TOML"),
        (b"\xff", "not UTF-8"),
        ("[[ignored]]\nrule = 'x'", "unknown table 'ignored'"),
        ("ignore = 3", "no list of tables"),
        ("ignore = [3]", "is no table"),
        ("[[ignore]]\nrule = 'no_server'", "rtron.toml:1: `reason` is missing"),
        ("[[ignore]]\nreason = 'x'", "`rule` is missing"),
        ("[[ignore]]\nrule = 'no_server'\nreason = ' '", "`reason` is no text"),
        ("[[ignore]]\nrule = 3\nreason = 'x'", "`rule` is no text"),
        ("[[ignore]]\nrule = 'no_sever'\nreason = 'x'", "unknown rule 'no_sever'"),
        ("[[ignore]]\nrule = 'no_server'\ntopics = 'x'\nreason = 'x'", "unknown key 'topics'"),
        ("x=" + "[" * 100_000, "not TOML"),
        ("#" * (MAX_BYTES + 1), "larger than"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, text, message):
    with pytest.raises(InputError) as raised:
        read(tmp_path, text)
    assert message in str(raised.value)


def test_the_nearest_rule_is_proposed(tmp_path):
    with pytest.raises(InputError) as raised:
        read(tmp_path, ENTRY.replace("no_server", "no_sever"))
    assert raised.value.help == "did you mean no_server?"

"""The closed grammar of `$(eval …)`: what it refuses, and how it is bounded."""

import pytest

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import evaluate, typed_argument

ARGUMENTS = {"s": "text", "i": 3, "long": "x" * 4000}


def value(text):
    return evaluate(text, {"find": lambda name: f"/{name}"}, ARGUMENTS.__getitem__)


@pytest.mark.parametrize(
    "text",
    [
        "open('/etc/passwd')",
        "exec('1')",
        "eval('1')",
        "getattr(s, 'upper')()",
        "s.encode()",
        "(1).real",
        "find.func_globals",
        "[x for x in s]",
        "(lambda: 1)()",
        "f'{s}'",
        "{**s}",
        "{1, 2}",
        "[*s]",
        "len(*s)",
        "sorted(s, reverse=True)",
        "(y := 1)",
        "await s",
        "i << 3",
        "i @ i",
        "'{0.real}'.format(i)",
        "'{:>{}}'.format(i, 9)",
        "'%(a)s' % i",
        "'%*d' % (9, i)",
    ],
)
def test_what_is_outside_the_grammar_is_not_evaluated(text):
    with pytest.raises(UnresolvableError):
        value(text)


@pytest.mark.parametrize(
    "text",
    [
        "9 ** 9 ** 9",
        "2 ** 1024",
        "2 ** 1023 * 4",
        "'x' * 10 ** 9",
        "10 ** 9 * 'x'",
        "[0] * 5",
        "long + long",
        "long.replace('x', long)",
        "long.join(long.split('x'))",
        "str(long.split('x')) * 2",
        "'%9999d' % 1",
        "'{:9999}'.format(1)",
        "round(1, -10 ** 9)",
        "int(long.replace('x', '9'))",
        "1" * 5000,
        "-" * 4000 + "1",
        "+".join(["1"] * 2000),
    ],
)
def test_what_would_be_expensive_is_not_evaluated(text):
    with pytest.raises((UnresolvableError, ValueError)):
        value(text)


@pytest.mark.parametrize(
    "text", ["", "1 +", "unknown", "s.__class__", "1 / 0", "s + 1", "s[9]", "a b", "\x00", "find()"]
)
def test_what_python_refuses_is_refused(text):
    with pytest.raises(ValueError):
        value(text)


def test_integers_may_have_1024_bits():
    assert value("2 ** 511 * 2 ** 511 * 2") == str(2**1023)
    with pytest.raises(UnresolvableError):
        value("2 ** 511 * 2 ** 511 * 4")


@pytest.mark.parametrize("length", [4095, 4096])
def test_strings_may_have_4096_characters(length):
    assert value(f"'x' * {length}") == "x" * length


def test_one_character_more_is_too_much():
    with pytest.raises(UnresolvableError):
        value("'x' * 4097")


def test_a_negative_repetition_is_empty():
    assert value("'x' * -1 + 'y'") == "y"


def test_the_surroundings_functions_are_called():
    assert value("find('pkg') + '/x'") == "/pkg/x"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", 1),
        ("1.5", 1.5),
        ("1_0", "1_0"),
        ("True", True),
        ("false", False),
        ("1e5", "1e5"),
        (".", "."),
        ("", ""),
        ("text", "text"),
    ],
)
def test_arguments_are_typed_as_roslaunch_types_them(text, expected):
    assert typed_argument(text) == expected
    assert type(typed_argument(text)) is type(expected)

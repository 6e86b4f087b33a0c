"""What `str()` and `repr()` make of values, against Python's own."""

import pytest

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.shown_text import repr_of, str_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    Choice,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    text_with_holes,
)


def abstract(value):
    """Return a plain value as the interpreter's."""
    if isinstance(value, dict):
        return MapValue({key: abstract(each) for key, each in value.items()})
    if isinstance(value, (list, tuple)):
        return list_of(map(abstract, value), type(value).__name__)
    return Scalar(value)


@pytest.mark.parametrize(
    "value",
    [{}, [], (), (1,), {"a": "it's", 2: [True, None, 1.5]}, ["x", ("y", {(1, "z"): b"w"})]],
    ids=str,
)
def test_a_known_value_is_shown_as_python_does(value):
    assert str_of(abstract(value)) == Scalar(str(value))
    assert repr_of(abstract(value)) == Scalar(repr(value))


def test_only_repr_puts_a_text_into_quotes():
    assert str_of(Scalar("a")) == Scalar("a")
    assert repr_of(Scalar("a")) == Scalar("'a'")


@pytest.mark.parametrize(
    ("inner", "shown"),
    [
        (Unknown("x"), "{'a': 1, 'b': {x}}"),
        (PartialText(("/", Unknown("ns"))), "{'a': 1, 'b': '/{ns}'}"),
    ],
)
def test_what_is_not_known_of_a_value_is_a_hole(inner, shown):
    assert text_with_holes(str_of(MapValue({"a": Scalar(1), "b": inner}))) == shown


def test_one_of_several_values_is_one_of_several_texts():
    value = MapValue({"b": Choice((Scalar("x"), Scalar(2)))})
    assert str_of(value) == Choice((Scalar("{'b': 'x'}"), Scalar("{'b': 2}")))


def test_a_value_without_an_end_is_not_known():
    value = list_of(())
    value.fields["items"] = (value,)
    assert "{?}" in text_with_holes(str_of(value))
    assert str_of(abstract([0] * 10_000)) is UNKNOWN
    opened = list_of((Scalar(1),), certain=False)
    assert str_of(opened) is opened

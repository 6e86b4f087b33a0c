"""What `str()` and `repr()` make of values, against Python's own."""

import pytest

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.abstract_values.shown_text import str_of


def abstract(value):
    """Return a plain value as the interpreter's."""
    if isinstance(value, dict):
        return av.MapValue({key: abstract(each) for key, each in value.items()})
    if isinstance(value, (list, tuple)):
        return av.list_of(map(abstract, value), type(value).__name__)
    return av.Scalar(value)


@pytest.mark.parametrize(
    "value",
    [{}, [], (), (1,), {"a": "it's", 2: [True, None, 1.5]}, ["x", ("y", {(1, "z"): b"w"})]],
    ids=str,
)
def test_a_known_value_is_shown_as_python_does(value):
    assert str_of(abstract(value)) == av.Scalar(str(value))
    assert av.repr_of(abstract(value)) == av.Scalar(repr(value))


def test_only_repr_puts_a_text_into_quotes():
    assert str_of(av.Scalar("a")) == av.Scalar("a")
    assert av.repr_of(av.Scalar("a")) == av.Scalar("'a'")


@pytest.mark.parametrize(
    ("inner", "shown"),
    [
        (av.Unknown("x"), "{'a': 1, 'b': {x}}"),
        (av.PartialText(("/", av.Unknown("ns"))), "{'a': 1, 'b': '/{ns}'}"),
    ],
)
def test_what_is_not_known_of_a_value_is_a_hole(inner, shown):
    assert av.text_with_holes(str_of(av.MapValue({"a": av.Scalar(1), "b": inner}))) == shown


def test_one_of_several_values_is_one_of_several_texts():
    value = av.MapValue({"b": av.Choice((av.Scalar("x"), av.Scalar(2)))})
    assert str_of(value) == av.Choice((av.Scalar("{'b': 'x'}"), av.Scalar("{'b': 2}")))


def test_a_value_without_an_end_is_not_known():
    value = av.list_of(())
    value.fields["items"] = (value,)
    assert "{?}" in av.text_with_holes(str_of(value))
    assert str_of(abstract([0] * 10_000)) is av.UNKNOWN
    opened = av.list_of((av.Scalar(1),), certain=False)
    assert str_of(opened) is opened

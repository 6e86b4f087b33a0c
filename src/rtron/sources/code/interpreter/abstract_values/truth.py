"""Whether a value counts as true."""

from collections.abc import Callable, Mapping
from typing import Any

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    ExternalSymbol,
    Instance,
    LibraryClass,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
)


def truth(value: Value) -> bool | None:
    """Return whether a value counts as true; None if that cannot be known.

    A library's object has a field for it: a ros::Subscriber does once subscribed.
    """
    if isinstance(value, Choice):
        answers = {truth(option) for option in value.options}
        return answers.pop() if len(answers) == 1 else None
    decide = _TRUTHS.get(type(value))
    return True if decide is None else decide(value)


def _truth_of_container(value: Any) -> bool | None:  # noqa: ANN401 - a list or a map
    filled = value.items if isinstance(value, ListValue) else value.entries
    return True if filled else (None if value.open else False)


def _truth_of_instance(value: Any) -> bool | None:  # noqa: ANN401 - an Instance
    if not isinstance(value.type, LibraryClass):
        return True
    return truth(value.fields["truth"]) if "truth" in value.fields else None


def _truth_of_text(value: Any) -> bool | None:  # noqa: ANN401 - a PartialText
    return True if any(isinstance(part, str) and part for part in value.parts) else None


_TRUTHS: Mapping[type, Callable[[Any], bool | None]] = {
    Scalar: lambda value: bool(value.value),
    ListValue: _truth_of_container,
    MapValue: _truth_of_container,
    Instance: _truth_of_instance,
    PartialText: _truth_of_text,
    Unknown: lambda _: None,
    ExternalSymbol: lambda _: None,
}

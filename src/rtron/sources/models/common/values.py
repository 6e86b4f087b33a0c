"""Values that a model computes with; what is not known stands in braces."""

from collections.abc import Mapping
from typing import Any

from rtron.vocabulary.parameters import UnknownValue

Value = Any

MAX_DEPTH = 20


class Placeholder(str):
    """A value that is not known: its name in braces, `{~prefix}`; stays a hole when looked into."""

    __slots__ = ()


def placeholder(name: str) -> Placeholder:
    """Return the hole for a name, whatever braces it already has."""
    return Placeholder("{" + name.replace("{", "").replace("}", "") + "}")


def with_placeholders(value: Value, name: str, depth: int = 0) -> Value:
    """Return a parameter's value with a hole for each UnknownValue, and for what is too deep."""
    if isinstance(value, UnknownValue) or depth > MAX_DEPTH:
        return placeholder(name)
    if isinstance(value, Mapping):
        return {
            key: with_placeholders(inner, f"{name}/{key}", depth + 1)
            for key, inner in value.items()
        }
    if isinstance(value, (list, tuple)):
        return [with_placeholders(inner, f"{name}/{i}", depth + 1) for i, inner in enumerate(value)]
    return value


def has_placeholder(value: Value) -> bool:
    """Tell whether a value is, or was built from, something that is not known."""
    return isinstance(value, str) and "{" in value


def as_switch(value: Value) -> bool:
    """Return what a value means as a switch: `0`, `false`, `no`, `off` and nothing are false."""
    if isinstance(value, str):
        return value.strip().lower() not in {"", "0", "false", "no", "off"}
    return bool(value)

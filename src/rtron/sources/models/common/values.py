"""Values that a model computes with; what is not known stands in braces."""

from collections.abc import Mapping
from typing import Any

from rtron.vocabulary.parameters import UnknownValue

Value = Any

MAX_DEPTH = 20


class Hole(str):
    """A value that is not known: its name in braces, `{~prefix}`; stays a hole when looked into."""

    __slots__ = ()


def hole(name: str) -> Hole:
    """Return the hole for a name, whatever braces it already has."""
    return Hole("{" + name.replace("{", "").replace("}", "") + "}")


def known(value: Value, name: str, depth: int = 0) -> Value:
    """Return a parameter's value with a hole for each UnknownValue, and for what is too deep."""
    if isinstance(value, UnknownValue) or depth > MAX_DEPTH:
        return hole(name)
    if isinstance(value, Mapping):
        return {key: known(inner, f"{name}/{key}", depth + 1) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [known(inner, f"{name}/{i}", depth + 1) for i, inner in enumerate(value)]
    return value


def has_hole(value: Value) -> bool:
    """Tell whether a value is, or was built from, something that is not known."""
    return isinstance(value, str) and "{" in value


def truth(value: Value) -> bool:
    """Return what a value means as a switch: `0`, `false`, `no`, `off` and nothing are false."""
    if isinstance(value, str):
        return value.strip().lower() not in {"", "0", "false", "no", "off"}
    return bool(value)

"""Texts of ROS 2 launch descriptions before they are evaluated, and what in them is not known.

A text is pieces: plain text, and calls of substitutions whose arguments are texts in turn. What has
no value here is a hole in the evaluated text, which says what it is called in the source.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

_OPEN, _CLOSE = "\ue000", "\ue001"
_HOLE = re.compile(f"{_OPEN}([^{_OPEN}{_CLOSE}]*){_CLOSE}")


@dataclass(frozen=True, slots=True)
class Call:
    """A substitution: `$(name argument…)`."""

    name: str
    arguments: tuple["Pieces", ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Deferred:
    """A substitution that a Python launch file defines itself; `run` gets what a launch knows."""

    run: Callable[[object], str]


Pieces: TypeAlias = "tuple[str | Call | Deferred, ...]"
Written: TypeAlias = "str | Pieces"
"""A text as it stands in XML or YAML, or taken apart."""


def hole(why: str) -> str:
    """Return the mark for a part of a text that is not known."""
    return f"{_OPEN}{shown(why)[:80]}{_CLOSE}"


def has_hole(text: str) -> bool:
    """Tell whether a part of a text is not known."""
    return _OPEN in text


def first_hole(text: str) -> str:
    """Return what the first hole of a text says; empty where it has none."""
    found = _HOLE.search(text)
    return found[1] if found else ""


def shown(text: str) -> str:
    """Return a text with each hole in braces."""
    return _HOLE.sub(r"{\1}", text).replace(_OPEN, "").replace(_CLOSE, "")


def with_holes(text: str, changed: Callable[[str], str]) -> str:
    """Return a text with what each of its holes says changed."""
    return _HOLE.sub(lambda found: hole(changed(found[1])), text)


def parts(text: str) -> list[tuple[str, bool]]:
    """Return a text's parts, and of each whether it is a hole; then it is what the hole says."""
    found = [(part, at % 2 == 1) for at, part in enumerate(_HOLE.split(text))]
    return [(part, is_hole) for part, is_hole in found if part or is_hole]

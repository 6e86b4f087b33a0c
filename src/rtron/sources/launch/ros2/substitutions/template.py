"""Texts of ROS 2 launch descriptions before they are evaluated, and what in them is not known.

A text is pieces: plain text, and calls of substitutions whose arguments are texts in turn. What has
no value here is a hole in the evaluated text, which says what it is called in the source.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.launch.common.errors import UnresolvableError

_OPEN, _CLOSE = "\ue000", "\ue001"
_PLACEHOLDER = re.compile(f"{_OPEN}([^{_OPEN}{_CLOSE}]*){_CLOSE}")


class UnknownPartError(UnresolvableError):
    """A text is needed whole of which a part is not known: why is noted where that part stands."""


@dataclass(frozen=True, slots=True)
class SubstitutionCall:
    """A substitution: `$(name argument…)`."""

    name: str
    arguments: tuple["Template", ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class DeferredSubstitution:
    """A substitution that a Python launch file defines; `perform` gets what a launch knows."""

    perform: Callable[[object], str]


Template: TypeAlias = "tuple[str | SubstitutionCall | DeferredSubstitution, ...]"
TemplateText: TypeAlias = "str | Template"
"""A text as it stands in XML or YAML, or taken apart."""


def placeholder(name: str) -> str:
    """Return the mark for a part of a text that is not known."""
    return f"{_OPEN}{display_text(name)[:80]}{_CLOSE}"


def has_placeholder(text: str) -> bool:
    """Tell whether a part of a text is not known."""
    return _OPEN in text


def require_known(text: str) -> str:
    """Return a text that is known whole; raise UnknownPartError for another."""
    if has_placeholder(text):
        raise UnknownPartError(f"'{display_text(text)[:80]}' is not known whole")
    return text


def first_placeholder(text: str) -> str:
    """Return what the first hole of a text says; empty where it has none."""
    match = _PLACEHOLDER.search(text)
    return match[1] if match else ""


def display_text(text: str) -> str:
    """Return a text with each hole in braces."""
    return _PLACEHOLDER.sub(r"{\1}", text).replace(_OPEN, "").replace(_CLOSE, "")


def map_placeholders(text: str, change: Callable[[str], str]) -> str:
    """Return a text with what each of its holes says changed."""
    return _PLACEHOLDER.sub(lambda found: placeholder(change(found[1])), text)


def split_placeholders(text: str) -> list[tuple[str, bool]]:
    """Return a text's parts, and of each whether it is a hole; then it is what the hole says."""
    split = [(part, at % 2 == 1) for at, part in enumerate(_PLACEHOLDER.split(text))]
    return [(part, is_placeholder) for part, is_placeholder in split if part or is_placeholder]

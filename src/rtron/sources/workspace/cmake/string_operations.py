"""What the operations of CMake's `string()` make of texts (CMake's manual, string)."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from rtron.sources.workspace.cmake.patterns import replace_plain
from rtron.sources.workspace.cmake.values import MAX_LENGTH, BoundsError

Operation: TypeAlias = Callable[[Sequence[str]], str | None]
"""Takes the arguments, the operation's name first; None: its result is not known."""


def _replace(words: Sequence[str]) -> str | None:
    """`string(REPLACE old new result text…)`."""
    _, old, new, _, *texts = words
    text = "".join(texts)
    if not old:
        return None
    _check_length(text.count(old) * len(new))
    return text.replace(old, new)


def _join(words: Sequence[str]) -> str:
    """`string(JOIN glue result text…)`."""
    _check_length(len(words) * len(words[1]))
    return words[1].join(words[3:])


def _substring(words: Sequence[str]) -> str | None:
    """`string(SUBSTRING text begin length result)`; a length below zero is the rest."""
    start, length = words[2], words[3].removeprefix("-")
    if not (start.isdecimal() and length.isdecimal() and len(start + length) < 12):  # noqa: PLR2004
        return None
    rest = words[1].encode()[int(start) :]
    part = rest if words[3].startswith("-") else rest[: int(length)]
    return part.decode(errors="replace")


def _find(words: Sequence[str]) -> str:
    """`string(FIND text part result [REVERSE])`."""
    text, part = words[1].encode(), words[2].encode()
    return str(text.rfind(part) if "REVERSE" in words[4:] else text.find(part))


def _replace_pattern(words: Sequence[str]) -> str | None:
    """`string(REGEX REPLACE pattern new result text…)`, of a plain pattern."""
    return replace_plain("".join(words[5:]), words[2], words[3])


def _unknown(_: Sequence[str]) -> None:
    return None


def _check_length(length: int) -> None:
    if length > MAX_LENGTH:
        raise BoundsError("a value becomes too long")


def string_operation(words: Sequence[str]) -> tuple[int, Operation] | None:
    """Return where an operation's result goes, and what it is; None for what has no result."""
    name = words[0].upper() if words else ""
    if name == "REGEX" and words[1:]:
        is_replacement = words[1].upper() == "REPLACE"
        return (4, _replace_pattern) if is_replacement else (3, _unknown)
    return _OPERATIONS.get(name)


_OPERATIONS: Mapping[str, tuple[int, Operation]] = {
    "TOLOWER": (2, lambda words: words[1].lower()),
    "TOUPPER": (2, lambda words: words[1].upper()),
    "STRIP": (2, lambda words: words[1].strip()),
    "LENGTH": (2, lambda words: str(len(words[1].encode()))),
    "CONCAT": (1, lambda words: "".join(words[2:])),
    "JOIN": (2, _join),
    "REPLACE": (3, _replace),
    "FIND": (3, _find),
    "SUBSTRING": (4, _substring),
    **dict.fromkeys(("TIMESTAMP", "UUID", "JSON"), (1, _unknown)),
    **dict.fromkeys(("MAKE_C_IDENTIFIER", "CONFIGURE", "GENEX_STRIP"), (2, _unknown)),
    "REPEAT": (3, _unknown),
}

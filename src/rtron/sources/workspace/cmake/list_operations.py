"""What the operations of CMake's `list()` make of a list (CMake's manual, list)."""

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from rtron.sources.workspace.cmake.command_call import MAX_LENGTH, BoundsError
from rtron.sources.workspace.cmake.patterns import plain_pattern, replace_plain

_FILTER_WORDS = 3


def _items_at(elements: list[str], indexes: Sequence[str]) -> list[str] | None:
    """Return the elements at some indexes, those below zero counted from the end."""
    numbers = [int(index) for index in indexes if _is_index(index, len(elements))]
    return [elements[number] for number in numbers] if len(numbers) == len(indexes) else None


def _is_index(text: str, length: int) -> bool:
    digits = text.removeprefix("-")
    return digits.isdecimal() and len(digits) < 6 and -length <= int(text) < length  # noqa: PLR2004


def _get(elements: list[str], indexes: Sequence[str]) -> str | None:
    found = _items_at(elements, indexes)
    return None if found is None else ";".join(found)


def _sublist(elements: list[str], words: Sequence[str]) -> str | None:
    start, length = (*words, "", "")[:2]
    if not _is_index(start, len(elements)) or not length.removeprefix("-").isdecimal():
        return None
    rest = elements[int(start) :]
    return ";".join(rest if length.startswith("-") else rest[: int(length[:6])])


def _find(elements: list[str], words: Sequence[str]) -> str:
    return str(elements.index(words[0]) if words and words[0] in elements else -1)


def _join(elements: list[str], words: Sequence[str]) -> str | None:
    glue = "".join(words)
    return glue.join(elements) if len(elements) * len(glue) <= MAX_LENGTH else None


def _remove_items(elements: list[str], words: list[str]) -> list[str]:
    removed = set(words)
    return [text for text in elements if text not in removed]


def _remove_at(elements: list[str], words: list[str]) -> list[str] | None:
    if not all(_is_index(word, len(elements)) for word in words):
        return None
    removed = {int(word) % len(elements) for word in words}
    return [text for position, text in enumerate(elements) if position not in removed]


def _filter(elements: list[str], words: list[str]) -> list[str] | None:
    """`list(FILTER name INCLUDE|EXCLUDE REGEX pattern)`."""
    pattern = plain_pattern(words[2]) if len(words) == _FILTER_WORDS else None
    if pattern is None or words[0] not in {"INCLUDE", "EXCLUDE"}:
        return None
    included = words[0] == "INCLUDE"
    return [text for text in elements if (pattern.match(text) is not None) is included]


def _transform(elements: list[str], words: list[str]) -> list[str] | None:
    """`list(TRANSFORM name action …)`, of all elements."""
    action, rest = words[0] if words else "", words[1:]
    if action in _TEXT_ACTIONS and not rest:
        return [_TEXT_ACTIONS[action](text) for text in elements]
    if len(elements) * sum(map(len, rest)) > MAX_LENGTH:
        return None
    if action in {"APPEND", "PREPEND"} and len(rest) == 1:
        return [text + rest[0] if action == "APPEND" else rest[0] + text for text in elements]
    if action == "REPLACE" and len(rest) in {1, 2}:
        changed = [replace_plain(text, rest[0], "".join(rest[1:])) for text in elements]
        known = [text for text in changed if text is not None]
        return known if len(known) == len(changed) else None
    return None


_TEXT_ACTIONS: Mapping[str, Callable[[str], str]] = {
    "TOLOWER": str.lower,
    "TOUPPER": str.upper,
    "STRIP": str.strip,
}
LIST_RESULTS: Mapping[str, Callable[[list[str], Sequence[str]], str | None]] = {
    "LENGTH": lambda elements, _: str(len(elements)),
    "GET": _get,
    "JOIN": _join,
    "SUBLIST": _sublist,
    "FIND": _find,
}
"""What is reported about a list in a variable; None: it is not known."""
LIST_CHANGES: Mapping[str, Callable[[list[str], list[str]], list[str] | None]] = {
    "APPEND": lambda elements, words: [*elements, *words],
    "PREPEND": lambda elements, words: [*words, *elements],
    "INSERT": lambda elements, words: [*elements, *words[1:]],
    "REMOVE_ITEM": _remove_items,
    "REMOVE_DUPLICATES": lambda elements, _: list(dict.fromkeys(elements)),
    "REMOVE_AT": _remove_at,
    "FILTER": _filter,
    "TRANSFORM": _transform,
    "REVERSE": lambda elements, _: elements[::-1],
    "SORT": lambda elements, _: sorted(elements),
}
"""What a list becomes; None: that is not known, and it stays as it is."""


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


def _join_strings(words: Sequence[str]) -> str:
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


def _find_string(words: Sequence[str]) -> str:
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
    "JOIN": (2, _join_strings),
    "REPLACE": (3, _replace),
    "FIND": (3, _find_string),
    "SUBSTRING": (4, _substring),
    **dict.fromkeys(("TIMESTAMP", "UUID", "JSON"), (1, _unknown)),
    **dict.fromkeys(("MAKE_C_IDENTIFIER", "CONFIGURE", "GENEX_STRIP"), (2, _unknown)),
    "REPEAT": (3, _unknown),
}

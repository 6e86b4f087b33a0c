"""From a YAML tree to the nouns of a plan; what is wrong is noted with its line, and left out."""

import re
from enum import Enum
from typing import Any, TypeVar

import yaml

from rtron.planning.plan_file.defaults import derived
from rtron.planning.plan_file.durations import parse_duration, write_duration
from rtron.planning.plan_file.fields import NOUNS, Key, keys
from rtron.planning.plan_file.problems import Faults, shown, suggestion

T = TypeVar("T")
_INTEGER = re.compile(r"-?(0|[1-9][0-9]{0,18})")
_BOOLEANS = {"true": True, "false": False}
_TAG = "tag:yaml.org,2002:"


class _Wrong:
    """Stands for a value that was wrong and has been noted."""


class Reader:
    """Reads nouns as `form` describes them, and remembers on which line each key stands."""

    def __init__(self, faults: Faults) -> None:
        self.faults = faults
        self._lines: dict[tuple[int, str], int] = {}
        self._kept: list[object] = []

    def line(self, noun: object, key: str = "") -> int:
        """Return the line of a noun that was read here, or of one of its keys."""
        return self._lines.get((id(noun), key)) or self._lines.get((id(noun), ""), 0)

    def noun(self, node: yaml.Node, kind: type[T]) -> T | None:
        """Return the noun in a mapping, without what is wrong; None if too little is left."""
        entries = self._entries(node, kind)
        known = keys(kind)
        values = {name: self._value(value, known[name]) for name, (_, value) in entries.items()}
        values = {name: value for name, value in values.items() if not isinstance(value, _Wrong)}
        needed = [key.name for key in known.values() if key.required]
        absent = [name for name in needed if name not in entries]
        if absent and isinstance(node, yaml.MappingNode):
            self._fault(node, f"{NOUNS[kind]} needs {' and '.join(absent)}")
        if not values.keys() >= set(needed):
            return None
        made = kind(**derived(kind, values))
        self._remember(made, node, entries)
        return made

    def _remember(
        self, made: object, node: yaml.Node, entries: dict[str, tuple[yaml.Node, yaml.Node]]
    ) -> None:
        self._kept.append(made)
        self._lines[id(made), ""] = node.start_mark.line + 1
        for name, (key, _) in entries.items():
            self._lines[id(made), name] = key.start_mark.line + 1

    def _entries(self, node: yaml.Node, kind: type) -> dict[str, tuple[yaml.Node, yaml.Node]]:
        if not isinstance(node, yaml.MappingNode):
            self._fault(node, f"{NOUNS[kind]} is a mapping with {', '.join(keys(kind))}")
            return {}
        entries: dict[str, tuple[yaml.Node, yaml.Node]] = {}
        for key, value in node.value:
            name = key.value if isinstance(key, yaml.ScalarNode) else ""
            if name not in keys(kind):
                near = suggestion(name, keys(kind))
                self._fault(key, f"unknown key {shown(name)} in {NOUNS[kind]}: {near}")
            elif name in entries:
                self._fault(key, f"{name} stands twice in {NOUNS[kind]}")
            else:
                entries[name] = (key, value)
        return entries

    def _value(self, node: yaml.Node, key: Key) -> Any:  # noqa: ANN401 - as the key says
        if not key.many:
            return self._item(node, key)
        if not isinstance(node, yaml.SequenceNode):
            self._fault(node, f"{key.name} is a list: write `- …` lines or [ … ]")
            return _Wrong()
        items = (self._item(item, key) for item in node.value)
        return tuple(item for item in items if not isinstance(item, _Wrong))

    def _item(self, node: yaml.Node, key: Key) -> Any:  # noqa: ANN401 - as the key says
        if key.optional and node.tag == _TAG + "null":
            return None
        if key.item in NOUNS:
            made = self.noun(node, key.item)
            return _Wrong() if made is None else made
        if not isinstance(node, yaml.ScalarNode):
            self._fault(node, f"{key.name} is a single value")
            return _Wrong()
        try:
            return _scalar(node, key)
        except ValueError as error:
            self._fault(node, f"{key.name}: {error}")
            return _Wrong()

    def _fault(self, node: yaml.Node, message: str) -> None:
        self.faults.add(node.start_mark.line + 1, message)


def _scalar(node: yaml.ScalarNode, key: Key) -> Any:  # noqa: ANN401 - as the key says
    if key.duration:
        return _duration(node.value, key.range)
    if key.quantity:
        return key.quantity.parse(node.value)
    if key.item is bool:
        return _boolean(node.value)
    if key.item is int:
        return _integer(node.value, key.range)
    if issubclass(key.item, Enum):
        return _word(node.value, key.item)
    return _text(node, key)


def _duration(text: str, limits: tuple[int, int]) -> int:
    least, greatest = limits
    duration = parse_duration(text)
    if duration < least or duration > greatest:
        bounds = f"{write_duration(least)} and {write_duration(greatest)}"
        told = f"not between {bounds}" if least > 1 else "no time at all"
        raise ValueError(f"{shown(text)} is {told}")
    return duration


def _boolean(text: str) -> bool:
    if text.lower() not in _BOOLEANS:
        raise ValueError(f"{shown(text)} is neither true nor false")
    return _BOOLEANS[text.lower()]


def _integer(text: str, limits: tuple[int, int]) -> int:
    least, greatest = limits
    if not _INTEGER.fullmatch(text):
        raise ValueError(f"{shown(text)} is no whole number")
    if not least <= int(text) <= greatest:
        raise ValueError(f"{text} is not between {least} and {greatest}")
    return int(text)


def _word(text: str, words: type[Enum]) -> Enum:
    known = {str(word.value): word for word in words}
    if text not in known:
        raise ValueError(f"unknown word {shown(text)}: {suggestion(text, known)}")
    return known[text]


def _text(node: yaml.ScalarNode, key: Key) -> str:
    if node.tag != _TAG + "str":
        raise ValueError(f"{shown(node.value)} is no text: put it in quotes")
    if not key.text.fits(node.value):
        raise ValueError(f"{shown(node.value)} is not {key.text.words}")
    return str(node.value)

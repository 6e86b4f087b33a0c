r"""`$(…)` of ROS 2's launch files (docs.ros.org: launch file formats, substitutions).

A text is fragments: plain text, with `\\` before what is meant literally, and `$(name argument…)`,
whose arguments may be quoted and hold substitutions in turn. Nothing is run.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.launch.expression import evaluate
from rtron.sources.launch.unresolvable import MissingArgumentError, UnresolvableError

Function: TypeAlias = Callable[[list[str]], str]

MAX_TEXT = 16_384
_MAX_DEPTH = 24
_NAME = re.compile(r"[A-Za-z][\w-]*")
_TRUE, _FALSE = frozenset({"true", "1"}), frozenset({"false", "0"})


def truth(text: str) -> bool:
    """Return what a condition says; raise ValueError where launch would refuse it."""
    word = text.strip().lower()
    if word not in _TRUE | _FALSE:
        raise ValueError(f"'{text[:80]}' is neither true nor false")
    return word in _TRUE


@dataclass(slots=True)
class Substitution:
    """Replaces substitutions; `functions` are those that depend on where the text stands."""

    functions: Mapping[str, Function]
    _text: str = ""
    _at: int = 0
    _depth: int = 0
    _all: Mapping[str, Function] = field(default_factory=dict)

    def replace(self, text: str) -> str:
        """Return a text with its substitutions replaced.

        Raise ValueError if it is malformed, UnresolvableError if it has no value here.
        """
        self._text, self._at, self._depth = _bounded(text), 0, 0
        self._all = {**_PURE, **self.functions}
        return self._fragments("")

    def _fragments(self, ends: str) -> str:
        """Return what stands up to one of the characters `ends`, or to the end of the text."""
        pieces: list[str] = []
        while self._at < len(self._text) and self._text[self._at] not in ends:
            if self._text.startswith("$(", self._at):
                pieces.append(self._called())
                continue
            escaped = self._text[self._at] == "\\" and self._at + 1 < len(self._text)
            self._at += escaped
            pieces.append(self._text[self._at])
            self._at += 1
        return _bounded("".join(pieces))

    def _called(self) -> str:
        self._depth += 1
        if self._depth > _MAX_DEPTH:
            raise ValueError(f"more than {_MAX_DEPTH} substitutions in each other")
        self._at += len("$(")
        name = _NAME.match(self._text, self._at)
        if name is None:
            raise ValueError("`$(` without a name")
        self._at = name.end()
        arguments = self._arguments()
        self._depth -= 1
        function = self._all.get(name[0])
        if function is None:
            raise UnresolvableError(f"$({name[0]} …) is not evaluated")
        return function(arguments)

    def _arguments(self) -> list[str]:
        found: list[str] = []
        while self._at < len(self._text):
            character = self._text[self._at]
            self._at += 1
            if character == ")":
                return found
            if character in "'\"":
                found.append(self._fragments(character))
                self._at += 1
            elif character != " ":
                self._at -= 1
                found.append(self._fragments(" )"))
        raise ValueError("`$(` without `)`")


def variable(configurations: Mapping[str, str]) -> Function:
    """Return what `$(var name default)` does."""

    def found(arguments: list[str]) -> str:
        name, *default = _given(arguments, 1, 2)
        if name in configurations:
            return configurations[name]
        if default:
            return default[0]
        raise MissingArgumentError(name)

    return found


def environment(environ: Mapping[str, str]) -> Function:
    """Return what `$(env NAME default)` does."""

    def found(arguments: list[str]) -> str:
        name, *default = _given(arguments, 1, 2)
        value = environ.get(name, default[0] if default else None)
        if value is None:
            raise UnresolvableError(f"the environment has no {name}")
        return value

    return found


def _bounded(text: str) -> str:
    if len(text) > MAX_TEXT:
        raise ValueError(f"longer than {MAX_TEXT} characters")
    return text


def _given(arguments: list[str], least: int, most: int) -> list[str]:
    if not least <= len(arguments) <= most:
        raise ValueError(f"{len(arguments)} arguments, expected {least} to {most}")
    return arguments


def _no_argument(name: str) -> str:
    raise KeyError(name)


def _said(value: bool) -> str:  # noqa: FBT001 - what launch writes for it
    return str(value).lower()


def _eval(arguments: list[str]) -> str:
    return evaluate(_given(arguments, 1, 2)[0], {}, _no_argument)


_PURE: Mapping[str, Function] = {
    "not": lambda words: _said(not truth(*_given(words, 1, 1))),
    "and": lambda words: _said(all(map(truth, _given(words, 2, 2)))),
    "or": lambda words: _said(any(map(truth, _given(words, 2, 2)))),
    "all": lambda words: _said(all(map(truth, words))),
    "any": lambda words: _said(any(map(truth, words))),
    "equals": lambda words: _said(len(set(_given(words, 2, 2))) == 1),
    "not-equals": lambda words: _said(len(set(_given(words, 2, 2))) != 1),
    "if": lambda words: (*_given(words, 2, 3), "")[1 if truth(words[0]) else 2],
    "eval": _eval,
}

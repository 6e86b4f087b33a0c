r"""`$(…)` of ROS 2's launch files (docs.ros.org: launch file formats, substitutions).

A text is fragments: plain text, with `\\` before what is meant literally, and `$(name argument…)`,
whose arguments may be quoted and hold substitutions in turn. Nothing is run.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.ros2.substitutions.functions import PURE, Function, given
from rtron.sources.launch.ros2.substitutions.template import (
    Call,
    Deferred,
    Pieces,
    Written,
    first_hole,
)

MAX_TEXT = 16_384
MAX_LONG = 65_536
"""The most for what only the graph asks for."""
MAX_PRINTED = 2**20
"""The most that a command prints: a parameter may be the description of a robot."""
_WHOLE = frozenset({"command", "file-content", "var", "if"})
"""What gives a text as it is, and may be longer where nothing stands beside it."""
_MAX_DEPTH = 24
_NAME = re.compile(r"[A-Za-z][\w-]*")


@dataclass(slots=True)
class _Parser:
    """Takes a text apart; raises ValueError where it is malformed."""

    text: str
    at: int = 0
    depth: int = 0

    def fragments(self, ends: str) -> Pieces:
        """Return what stands up to one of the characters `ends`, or to the end of the text."""
        pieces: list[str | Call | Deferred] = []
        plain: list[str] = []
        while self.at < len(self.text) and self.text[self.at] not in ends:
            if self.text.startswith("$(", self.at):
                pieces += filter(None, ["".join(plain), self._call()])
                plain = []
                continue
            escaped = self.text[self.at] == "\\" and self.at + 1 < len(self.text)
            self.at += escaped
            plain.append(self.text[self.at])
            self.at += 1
        return (*pieces, "".join(plain)) if plain else tuple(pieces)

    def _call(self) -> Call:
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise ValueError(f"more than {_MAX_DEPTH} substitutions in each other")
        self.at += len("$(")
        name = _NAME.match(self.text, self.at)
        if name is None:
            raise ValueError("`$(` without a name")
        self.at = name.end()
        call = Call(name[0], tuple(self._arguments()))
        self.depth -= 1
        return call

    def _arguments(self) -> list[Pieces]:
        found: list[Pieces] = []
        while self.at < len(self.text):
            character = self.text[self.at]
            self.at += 1
            if character == ")":
                return found
            if character in "'\"":
                found.append(self.fragments(character))
                self.at += 1
            elif character != " ":
                self.at -= 1
                found.append(self.fragments(" )"))
        raise ValueError("`$(` without `)`")


@dataclass(slots=True)
class Substitution:
    """Replaces substitutions; `functions` are those that depend on where the text stands.

    `failed` gets what has no value here and returns what stands for it, or raises; `view` is what a
    substitution gets that the launch file defines itself.
    """

    functions: Mapping[str, Function]
    failed: Callable[[str, Exception], str] | None = None
    view: object = None
    most: int = MAX_TEXT

    def replace(self, text: Written) -> str:
        """Return a text with its substitutions replaced.

        Raise ValueError if it is malformed, UnresolvableError if it has no value here.
        """
        return self.perform(self.parsed(text))

    def parsed(self, text: Written) -> Pieces:
        """Return a text taken apart; raise ValueError if it is malformed."""
        return _Parser(self._bounded(text)).fragments("") if isinstance(text, str) else text

    def perform(self, pieces: Pieces) -> str:
        """Return a text that is taken apart already, its substitutions replaced."""
        found = (piece if isinstance(piece, str) else self._piece(piece) for piece in pieces)
        text = "".join(found)
        return text if len(pieces) == 1 and _is_whole(pieces[0]) else self._bounded(text)

    def _piece(self, piece: Call | Deferred) -> str:
        if isinstance(piece, Deferred):
            return piece.run(self.view)
        arguments = [self.perform(argument) for argument in piece.arguments]
        if self.failed is None:
            return self._called(piece.name, arguments)
        try:
            return self._called(piece.name, arguments)
        except (UnresolvableError, MissingArgumentError, ValueError, LookupError) as error:
            return self.failed(_called(piece.name, arguments), error)

    def _bounded(self, text: str) -> str:
        if len(text) > self.most:
            raise ValueError(f"longer than {self.most} characters")
        return text

    def _called(self, name: str, arguments: list[str]) -> str:
        function = self.functions.get(name) or PURE.get(name)
        if function is None:
            raise UnresolvableError(f"$({name} …) is not evaluated")
        return function(arguments)


def _is_whole(piece: str | Call | Deferred) -> bool:
    return isinstance(piece, str) or (isinstance(piece, Call) and piece.name in _WHOLE)


def _called(name: str, arguments: list[str]) -> str:
    """Return what to call what has no value: as what is not known in it, where there is any."""
    text = " ".join(arguments)
    return first_hole(text) or (arguments[0] if name == "var" else f"{name} {text}".strip())


def variable(configurations: Mapping[str, str]) -> Function:
    """Return what `$(var name default)` does."""

    def found(arguments: list[str]) -> str:
        name, *default = given(arguments, 1, 2)
        if name in configurations:
            return configurations[name]
        if default:
            return default[0]
        raise MissingArgumentError(name)

    return found


def environment(environ: Mapping[str, str]) -> Function:
    """Return what `$(env NAME default)` does."""

    def found(arguments: list[str]) -> str:
        name, *default = given(arguments, 1, 2)
        value = environ.get(name, default[0] if default else None)
        if value is None:
            raise UnresolvableError(f"the environment has no {name}")
        return value

    return found

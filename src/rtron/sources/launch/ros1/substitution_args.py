"""`$(…)` in a launch file's attributes (ROS wiki: roslaunch/XML, substitution args)."""

import os.path
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.launch.common.environment import look_up
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.common.expression import evaluate, typed_argument
from rtron.sources.launch.common.expression_library import ANONYMOUS_SUFFIX, Function, Value
from rtron.sources.launch.common.packages import PackageIndex

Argument: TypeAlias = str | UnresolvableError
"""An argument's value; one that cannot be resolved here is raised wherever it is used."""

_COMMAND = re.compile(r"\$\(([^()$]+)\)")
_NESTED = re.compile(r"\$\([^()$]*[($]")
_EVAL = re.compile(r"\$\(eval (.*)\)", re.DOTALL)
_COMMAND_NAMES = frozenset({"anon", "arg", "dirname", "env", "find", "optenv"})
_MAX_ADDED_LENGTH = 64 * 1024


@dataclass(frozen=True, slots=True, kw_only=True)
class SubstitutionArgs:
    """Replaces every `$(…)` in texts of one launch file; `folder` is what `$(dirname)` means.

    `used` gets the names of the arguments that texts use, declared or not: roslaunch takes them
    from its command line.
    """

    packages: PackageIndex
    environ: Mapping[str, str]
    folder: str
    arguments: Mapping[str, Argument]
    used: set[str] = field(default_factory=set)

    def replace(self, text: str) -> str:
        """Return `text` with its substitutions made, `$(find …)` last as its path may use others.

        Raise ValueError where roslaunch would refuse the text, MissingArgumentError for an
        argument without a value, UnresolvableError for what this machine lacks.
        """
        expression = _EVAL.fullmatch(text)
        if expression:
            return evaluate(expression[1], self._functions(), self._typed_argument)
        limit = len(text) + _MAX_ADDED_LENGTH
        for command in _commands(text):
            text = self._replace_command(text, command, limit)
        for command in _commands(text):
            if command.split()[0] == "find":
                text = self._replace_find(text, command)
        return text

    def _replace_command(self, text: str, command: str, limit: int) -> str:
        name, *arguments = command.split()
        if name == "find":
            return text
        value = self._command_value(command, name, arguments)
        substitution_text = f"$({command})"
        if len(text) + text.count(substitution_text) * len(value) > limit:
            raise UnresolvableError(f"{substitution_text} makes a text that is too long")
        return text.replace(substitution_text, value)

    def _command_value(self, command: str, name: str, arguments: list[str]) -> str:
        if name == "dirname":
            return self.folder
        if name == "optenv" and arguments:
            return str(self._optenv(arguments[0], " ".join(arguments[1:])))
        if name == "optenv" or len(arguments) != 1:
            raise ValueError(f"$({command}) takes one word")
        calls: Mapping[str, Callable[[str], str]] = {
            "anon": _anonymous_name,
            "arg": self._argument,
            "env": self._env,
        }
        return calls[name](arguments[0])

    def _replace_find(self, text: str, command: str) -> str:
        _, *arguments = command.split()
        if len(arguments) != 1:
            raise ValueError(f"$({command}) takes one word")
        before, _, after = text.partition(f"$({command})")
        path, space, rest = after.partition(" ")
        inside = path.replace("\\", "/").removeprefix("/")
        found = self._find(arguments[0])
        if inside:
            found = os.path.join(found, inside)  # noqa: PTH118 - keep `..`
        return before + found + space + rest

    def _functions(self) -> Mapping[str, Function]:
        return {
            "anon": _anonymous_name,
            "arg": lambda name: typed_argument(self._argument(name)),
            "dirname": lambda: self.folder,
            "env": self._env,
            "find": self._find,
            "optenv": self._optenv,
        }

    def _argument(self, name: str) -> str:
        self.used.add(name)
        if name not in self.arguments:
            raise MissingArgumentError(name)
        value = self.arguments[name]
        if isinstance(value, UnresolvableError):
            raise value
        return value

    def _typed_argument(self, name: str) -> Value:
        if name not in self.arguments:
            raise ValueError(f"`{name}` is no argument")
        return typed_argument(self._argument(name))

    def _env(self, name: str) -> str:
        value = look_up(self.environ, name)
        if value is None:
            raise UnresolvableError(f"environment variable {name} is not set")
        return value

    def _optenv(self, name: str, default: Value = "") -> Value:
        """Return a variable, else the default as it is: in an expression it may be a number."""
        value = look_up(self.environ, name, str(default))
        return value if name in self.environ else default

    def _find(self, package: str) -> str:
        if package not in self.packages:
            raise UnresolvableError(f"package '{package}' is not found", package)
        return str(self.packages[package])


def _anonymous_name(name: str) -> str:
    return name + ANONYMOUS_SUFFIX


def _commands(text: str) -> list[str]:
    if _NESTED.search(text):
        raise ValueError(f"'{text}' has a substitution inside another")
    commands: list[str] = _COMMAND.findall(text)
    for command in commands:
        if not _COMMAND_NAMES.intersection(command.split()[:1]):
            raise ValueError(
                f"$({command}) is no substitution: {', '.join(sorted(_COMMAND_NAMES))}"
            )
    return commands

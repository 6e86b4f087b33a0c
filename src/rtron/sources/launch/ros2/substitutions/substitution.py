r"""`$(…)` of ROS 2's launch files (docs.ros.org: launch file formats, substitutions).

A text is fragments: plain text, with `\\` before what is meant literally, and `$(name argument…)`,
whose arguments may be quoted and hold substitutions in turn. Nothing is run.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.ros2.substitutions.functions import (
    PURE_FUNCTIONS,
    Function,
    require_arguments,
)
from rtron.sources.launch.ros2.substitutions.template import (
    DeferredSubstitution,
    SubstitutionCall,
    Template,
    TemplateText,
    first_placeholder,
)

MAX_TEXT = 16_384
MAX_GRAPH_TEXT = 65_536
"""The most for what only the graph asks for."""
MAX_COMMAND_OUTPUT = 2**20
"""The most that a command prints: a parameter may be the description of a robot."""
_UNBOUNDED_CALLS = frozenset({"command", "file-content", "var", "if"})
"""What gives a text as it is, and may be longer where nothing stands beside it."""
_MAX_DEPTH = 24
_NAME = re.compile(r"[A-Za-z][\w-]*")
_ROS1_NAMES = {"arg": "var", "find": "find-pkg-share"}


@dataclass(slots=True)
class _TemplateParser:
    """Takes a text apart; raises ValueError where it is malformed."""

    text: str
    position: int = 0
    depth: int = 0

    def fragments(self, terminators: str) -> Template:
        """Return what stands before one of the characters `terminators`, or the end."""
        parts: list[str | SubstitutionCall | DeferredSubstitution] = []
        literal: list[str] = []
        while self.position < len(self.text) and self.text[self.position] not in terminators:
            if self.text.startswith("$(", self.position):
                parts += filter(None, ["".join(literal), self._call()])
                literal = []
                continue
            escaped = self.text[self.position] == "\\" and self.position + 1 < len(self.text)
            self.position += escaped
            literal.append(self.text[self.position])
            self.position += 1
        return (*parts, "".join(literal)) if literal else tuple(parts)

    def _call(self) -> SubstitutionCall:
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise ValueError(f"more than {_MAX_DEPTH} substitutions in each other")
        self.position += len("$(")
        name = _NAME.match(self.text, self.position)
        if name is None:
            raise ValueError("`$(` without a name")
        self.position = name.end()
        call = SubstitutionCall(name[0], tuple(self._arguments()))
        self.depth -= 1
        return call

    def _arguments(self) -> list[Template]:
        arguments: list[Template] = []
        while self.position < len(self.text):
            character = self.text[self.position]
            self.position += 1
            if character == ")":
                return arguments
            if character in "'\"":
                arguments.append(self.fragments(character))
                self.position += 1
            elif character != " ":
                self.position -= 1
                arguments.append(self.fragments(" )"))
        raise ValueError("`$(` without `)`")


@dataclass(slots=True)
class SubstitutionEvaluator:
    """Replaces substitutions; `functions` are those that depend on where the text stands.

    `on_error` gets what has no value here and returns what stands for it, or raises; `context_view`
    is what a substitution gets that the launch file defines itself.
    """

    functions: Mapping[str, Function]
    on_error: Callable[[str, Exception], str] | None = None
    context_view: object = None
    max_length: int = MAX_TEXT

    def evaluate(self, text: TemplateText) -> str:
        """Return a text with its substitutions replaced.

        Raise ValueError if it is malformed, UnresolvableError if it has no value here.
        """
        return self.evaluate_template(self.parse(text))

    def parse(self, text: TemplateText) -> Template:
        """Return a text taken apart; raise ValueError if it is malformed."""
        return (
            _TemplateParser(self._check_length(text)).fragments("")
            if isinstance(text, str)
            else text
        )

    def evaluate_template(self, template: Template) -> str:
        """Return a text that is taken apart already, its substitutions replaced."""
        parts = (part if isinstance(part, str) else self._evaluate_part(part) for part in template)
        text = "".join(parts)
        return (
            text if len(template) == 1 and _may_be_long(template[0]) else self._check_length(text)
        )

    def _evaluate_part(self, part: SubstitutionCall | DeferredSubstitution) -> str:
        if isinstance(part, DeferredSubstitution):
            return part.perform(self.context_view)
        arguments = [self.evaluate_template(argument) for argument in part.arguments]
        if self.on_error is None:
            return self._call_function(part.name, arguments)
        try:
            return self._call_function(part.name, arguments)
        except (UnresolvableError, MissingArgumentError, ValueError, LookupError) as error:
            return self.on_error(_call_name(part.name, arguments), error)

    def _check_length(self, text: str) -> str:
        if len(text) > self.max_length:
            raise ValueError(f"longer than {self.max_length} characters")
        return text

    def _call_function(self, name: str, arguments: list[str]) -> str:
        function = self.functions.get(name) or PURE_FUNCTIONS.get(name)
        if function is None:
            hint = f": ROS 2 writes $({_ROS1_NAMES[name]} …)" if name in _ROS1_NAMES else ""
            raise UnresolvableError(f"$({name} …) is not evaluated{hint}")
        return function(arguments)


def _may_be_long(part: str | SubstitutionCall | DeferredSubstitution) -> bool:
    return isinstance(part, str) or (
        isinstance(part, SubstitutionCall) and part.name in _UNBOUNDED_CALLS
    )


def _call_name(name: str, arguments: list[str]) -> str:
    """Return what to call what has no value: as what is not known in it, where there is any."""
    text = " ".join(arguments)
    return first_placeholder(text) or (arguments[0] if name == "var" else f"{name} {text}".strip())


def configuration_function(configurations: Mapping[str, str]) -> Function:
    """Return what `$(var name default)` does."""

    def found(arguments: list[str]) -> str:
        name, *default = require_arguments(arguments, 1, 2)
        if name in configurations:
            return configurations[name]
        if default:
            return default[0]
        raise MissingArgumentError(name)

    return found


def environment_function(environ: Mapping[str, str]) -> Function:
    """Return what `$(env NAME default)` does."""

    def found(arguments: list[str]) -> str:
        name, *default = require_arguments(arguments, 1, 2)
        value = environ.get(name, default[0] if default else None)
        if value is None:
            raise UnresolvableError(f"the environment has no {name}")
        return value

    return found

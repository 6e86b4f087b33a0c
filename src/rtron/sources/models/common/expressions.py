"""Expressions and templates of a model, in the closed grammar of `$(eval …)`; never Python's eval.

A template is a text with expressions in braces: `{param('~prefix', 'robot')}/odom`.
"""

import re
from dataclasses import dataclass
from functools import cached_property

from rtron.sources.launch.common.expression import evaluate
from rtron.sources.models.common.functions import Function, model_functions
from rtron.sources.models.common.model_scope import ModelScope
from rtron.sources.models.common.values import Placeholder, Value, has_placeholder

_BRACES = re.compile(r"\{([^{}]*)\}")
_NAME = re.compile(r"~?[A-Za-z0-9_/]*", re.ASCII)


@dataclass
class ModelExpressions:
    """Evaluates expressions in one scope; `has_unknown` tells that an answer was not known."""

    scope: ModelScope
    has_unknown: bool = False

    @cached_property
    def _functions(self) -> dict[str, Function]:
        return {name: self._tracked(f) for name, f in model_functions(self.scope).items()}

    def value(self, text: str) -> Value:
        """Return an expression's value; raise ValueError or UnresolvableError if it has none."""
        results: list[Value] = []
        evaluate(f"keep({text})", {**self._functions, "keep": results.append}, self._variable)
        return results[0]

    def text(self, template: str) -> str:
        """Return a template with its expressions' values filled in; they must be plain values."""
        return _BRACES.sub(lambda braces: self._plain_text(braces[1]), template)

    def name(self, template: str) -> str:
        """Return the ROS name that a template gives; raise ValueError if it is none."""
        name = self.text(template)
        if not _NAME.fullmatch(_BRACES.sub("", name)) or not name:
            raise ValueError(f"{name[:80]!r} is no name")
        return name

    def _plain_text(self, text: str) -> str:
        value = self.value(text)
        if not isinstance(value, (str, int, float)):
            raise ValueError(f"{text[:80]} gives no plain value")  # noqa: TRY004 - as every other fault here
        return str(value)

    def _variable(self, name: str) -> Value:
        return self._track(self.scope.variables[name])

    def _tracked(self, function: Function) -> Function:
        return lambda *arguments: self._track(function(*arguments))

    def _track(self, value: Value) -> Value:
        self.has_unknown = (
            self.has_unknown or isinstance(value, Placeholder) or has_placeholder(value)
        )
        return value

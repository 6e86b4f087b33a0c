"""Expressions and templates of a model, in the closed grammar of `$(eval …)`; never Python's eval.

A template is a text with expressions in braces: `{param('~prefix', 'robot')}/odom`.
"""

import ast
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

from rtron.sources.launch.common.expression import ExpressionEvaluator, evaluate_with
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
    def _evaluator(self) -> "_ModelEvaluator":
        return _ModelEvaluator(model_functions(self.scope), self._variable, self._track)

    def value(self, text: str) -> Value:
        """Return an expression's value; raise ValueError or UnresolvableError if it has none."""
        return evaluate_with(self._evaluator, f"({text})")  # it may have several lines

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

    def _track(self, value: Value) -> Value:
        self.has_unknown = (
            self.has_unknown or isinstance(value, Placeholder) or has_placeholder(value)
        )
        return value


class _ModelEvaluator(ExpressionEvaluator):
    """Evaluates an expression of a model, and shows what a model's functions give."""

    def __init__(
        self,
        functions: Mapping[str, Function],
        argument: Callable[[str], Value],
        track: Callable[[Value], Value],
    ) -> None:
        super().__init__(functions, argument)
        self._model_functions, self._track = functions, track

    def _function(self, node: ast.expr) -> Function:
        function = super()._function(node)
        if not (isinstance(node, ast.Name) and node.id in self._model_functions):
            return function
        return lambda *arguments: self._track(function(*arguments))

"""The expressions of a model, and the place where its node runs: its own name and remap rules."""

import ast
import re
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from rtron.sources.declaration import NodeSite
from rtron.sources.launch.common.expression import ExpressionEvaluator, evaluate_with
from rtron.sources.models.common.functions import Function, model_functions
from rtron.sources.models.common.model_scope import (
    ModelScope,
    Placeholder,
    Value,
    has_placeholder,
    node_scope,
)
from rtron.vocabulary.launch import canonical_name
from rtron.vocabulary.remap_rules import parse_remap_rules

_BRACES = re.compile(r"\{([^{}]*)\}")
_NAME = re.compile(r"~?[A-Za-z0-9_/]*", re.ASCII)


def resolve_ros2_site(default_name: str, site: NodeSite) -> NodeSite:
    """Return a site with its own remap rules, and the node's own name if its launch gives none.

    The own name is a template, as a model has it.
    """
    site = replace(
        site, remaps=(*parse_remap_rules(shlex.join(site.args), in_ros_args=False), *site.remaps)
    )
    if not default_name or _has_launch_name(site):
        return site
    node_name = ModelExpressions(node_scope(site)).text(default_name)
    return replace(site, name=canonical_name(f"{site.name.rpartition('/')[0]}/{node_name}"))


def _has_launch_name(site: NodeSite) -> bool:
    """Tell whether a launch names a node: what it says of a component's process is not for it."""
    is_process = site.loading is None
    return (site.has_launch_name and is_process) or any(
        word.startswith("__node:=") for word in site.args
    )


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

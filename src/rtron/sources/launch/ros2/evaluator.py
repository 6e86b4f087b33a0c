"""The texts of a ROS 2 launch file evaluated: attributes, conditions, remaps and configurations."""

import os.path
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TypeAlias

from rtron.sources.launch.common.environment import look_up
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.choices import LaunchChoices
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.launch_context import LaunchContext, LaunchVariable
from rtron.sources.launch.ros2.limits import LaunchLimits
from rtron.sources.launch.ros2.parameters.file import YamlFileCache
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES
from rtron.sources.launch.ros2.substitutions.command_output import CommandOutput
from rtron.sources.launch.ros2.substitutions.functions import (
    Function,
    format_bool,
    loop_variable,
    require_arguments,
)
from rtron.sources.launch.ros2.substitutions.package_lookup import PackageLookup
from rtron.sources.launch.ros2.substitutions.substitution import (
    MAX_GRAPH_TEXT,
    SubstitutionEvaluator,
    configuration_function,
    environment_function,
)
from rtron.sources.launch.ros2.substitutions.template import placeholder, require_known
from rtron.sources.launch.ros2.unresolved import UnresolvedNotes
from rtron.vocabulary import UnknownValue, WiringFact
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, RemapRule

Setting: TypeAlias = tuple[LaunchVariable, str | None, frozenset[LaunchVariable]]
"""A variable, its value, None for one that is not known, and the variables that decide it."""


@dataclass(slots=True, kw_only=True)
class LaunchEvaluator(UnresolvedNotes):
    """Evaluates what stands in elements, and notes what has no value before the launch runs.

    `dependencies` are the arguments and variables that decided what was evaluated last. Where it is
    `symbolic`, a text keeps what is known of it: the rest are placeholders, each noted once.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    choices: LaunchChoices
    locate_source: Callable[[str], str] = str
    files: YamlFileCache = field(init=False)
    command_output: CommandOutput = field(init=False)
    limits: LaunchLimits = field(default_factory=LaunchLimits)
    dependencies: set[LaunchVariable] = field(default_factory=set)
    wiring: list[WiringFact] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Let the files count in the same bounds, and commands make notes."""
        self.files = YamlFileCache(self.limits, self.locate_source)
        self.command_output = CommandOutput(
            packages=self.packages,
            environ=self.environ,
            locate_source=self.locate_source,
            unresolved=self.unresolved,
        )

    def text(self, site: ElementSite, key: str) -> str | None:
        """Return an attribute's value as `value` does; it decides what starts, or a name."""
        value = self.value(site, key)
        self.choices.decide(self.dependencies)
        return value

    def value(self, site: ElementSite, key: str) -> str | None:
        """Return an attribute's value; None where it is not written, or, noted, has none here.

        Afterwards `dependencies` has the arguments and variables that decide it.
        """
        self.dependencies = set()
        template = site.element.attributes.get(key)
        if template is None:
            return None
        with self.collect_errors(site):
            return self.substitution_evaluator(site).evaluate(template)
        return None

    def remap_rules(self, sites: Iterable[ElementSite]) -> list[RemapRule]:
        """Return the remap rules that elements say, `*` for a name that is not known."""
        rules = []
        for site in sites:
            self.limits.count_action(site.file.path, site.context)
            source, target = (self.text(site, key) or UNKNOWN_NAME for key in ("from", "to"))
            rules.append((source, target))
        return rules

    def configurations(self, sites: Iterable[ElementSite]) -> Iterator[Setting]:
        """Yield the configurations that elements set, and what decides their values."""
        for site in sites:
            name = self.text(site, "name")
            value = self.value(site, "value")
            if name is not None:
                yield LaunchVariable(name), value, frozenset(self.dependencies)

    def substitution_evaluator(self, site: ElementSite) -> SubstitutionEvaluator:
        """Return what replaces substitutions in an element's texts."""
        functions = self._functions(site)
        if not self.symbolic:
            return SubstitutionEvaluator(functions)

        def failed(what: str, error: Exception) -> str:
            self.note_error(site, error)
            return placeholder(what)

        evaluator = SubstitutionEvaluator(functions, failed, max_length=MAX_GRAPH_TEXT)
        evaluator.context_view = self._context_view(site, evaluator)
        return evaluator

    def context_view(self, site: ElementSite) -> ContextView:
        """Return what a function of a Python launch file sees of the launch."""
        return self._context_view(site, self.substitution_evaluator(site))

    def _context_view(self, site: ElementSite, evaluator: SubstitutionEvaluator) -> ContextView:
        note = partial(self.note, site)
        perform = evaluator.evaluate
        return ContextView(perform=perform, context=site.context, note=note, files=self.files)

    def _functions(self, site: ElementSite) -> Mapping[str, Function]:
        context = site.context
        path = site.file.path
        folder = os.path.dirname(path)  # noqa: PTH120 - a string in a string out

        def looked_up(
            function: Function, arguments: list[str], *, environment: bool = False
        ) -> str:
            variable = LaunchVariable("".join(arguments[:1]), environment)
            if not environment:  # who gives it is heard, declared or not
                self.choices.declared.add(variable.name)
            if environment and variable.name not in context.environ:
                look_up(self.environ, *arguments[:2])
            self.dependencies |= context.dependencies_of(variable)
            if variable in context.unknown:
                raise UnresolvableError(f"the value of '{variable.name}' is not known")
            return function(arguments)

        value = configuration_function(context.configurations)
        variable_value = environment_function(context.environ)
        lookup = PackageLookup(self.environ, self.packages, self.symbolic, self.command_output)
        return {
            "var": lambda words: looked_up(value, words),
            "env": lambda words: looked_up(variable_value, words, environment=True),
            "optenv": lambda words: looked_up(variable_value, [*words, ""][:2], environment=True),
            "dirname": lambda _: folder,
            "filename": lambda _: path,
            "anon": lambda words: f"{words[0]}_{UNKNOWN_NAME}",
            "config-equals": partial(_configuration_equals, context),
            "for-var": loop_variable(context.loops),
            "index": loop_variable(context.loops),
            "param": partial(_global_parameter, context),
            "node-name": lambda words: context.full_name(*words),
            **lookup.functions(),
        }


def _global_parameter(context: LaunchContext, arguments: list[str]) -> str:
    """Return a parameter for all nodes, the first of its name (launch_ros: Parameter)."""
    name, *default = require_arguments(arguments, 1, 2)
    entries = (entry for source in context.parameters or () for entry in source.entries)
    for pattern, values in entries:
        if pattern == ALL_NODES and name in values:
            value = values[name].value
            if isinstance(value, UnknownValue):
                raise UnresolvableError(value.why)
            return str(value)
    if not default:
        raise UnresolvableError(f"no parameter '{name}' is set for all nodes")
    return default[0]


def _configuration_equals(context: LaunchContext, arguments: list[str]) -> str:
    """Return whether a configuration is set to a value; one that is not set is set to nothing."""
    value = context.configurations.get(arguments[0], "")
    return format_bool(require_known(value) == require_known("".join(arguments[1:])))

"""The texts of a ROS 2 launch file evaluated: attributes, conditions, remaps and configurations."""

import os.path
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.choices import LaunchChoices
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.inclusion import FileInclusion
from rtron.sources.launch.ros2.launch_context import LaunchContext, LaunchVariable
from rtron.sources.launch.ros2.limits import LaunchLimits
from rtron.sources.launch.ros2.parameters.file_cache import YamlFileCache
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES
from rtron.sources.launch.ros2.substitutions.command_output import CommandOutput
from rtron.sources.launch.ros2.substitutions.functions import (
    Function,
    format_bool,
    parse_condition,
    require_arguments,
    require_known,
)
from rtron.sources.launch.ros2.substitutions.loops import loop_variable
from rtron.sources.launch.ros2.substitutions.package_lookup import PackageLookup
from rtron.sources.launch.ros2.substitutions.substitution import (
    MAX_GRAPH_TEXT,
    SubstitutionEvaluator,
    configuration_function,
    environment_function,
)
from rtron.sources.launch.ros2.substitutions.template import placeholder
from rtron.sources.launch.ros2.unresolved import UnresolvedNotes
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import UnknownValue
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, RemapRule


@dataclass(slots=True, kw_only=True)
class LaunchEvaluator(UnresolvedNotes):
    """Evaluates what stands in elements, and notes what has no value before the launch runs.

    `dependencies` are the arguments and variables that decided what was evaluated last. Where it is
    `symbolic`, a text keeps what is known of it: the rest are holes (`pieces`), each noted once.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    choices: LaunchChoices
    locate_source: Callable[[str], str] = str
    files: YamlFileCache = field(init=False)
    command_output: CommandOutput = field(init=False)
    limits: LaunchLimits = field(default_factory=LaunchLimits)
    dependencies: set[LaunchVariable] = field(default_factory=set)

    def __post_init__(self) -> None:
        """Let the files count in the same bounds, and commands make notes."""
        self.files = YamlFileCache(self.limits, self.locate_source)
        self.command_output = CommandOutput(
            packages=self.packages,
            environ=self.environ,
            locate_source=self.locate_source,
            unresolved=self.unresolved,
        )

    def text(
        self, element: Element, key: str, context: LaunchContext, file: FileInclusion
    ) -> str | None:
        """Return an attribute's value as `value` does; it decides what starts, or a name."""
        value = self.value(element, key, context, file)
        self.choices.decide(self.dependencies)
        return value

    def value(
        self, element: Element, key: str, context: LaunchContext, file: FileInclusion
    ) -> str | None:
        """Return an attribute's value; None where it is not written, or, noted, has none here.

        Afterwards `dependencies` has the arguments and variables that decide it.
        """
        self.dependencies = set()
        template = element.attributes.get(key)
        if template is None:
            return None
        with self.collect_errors(element, file):
            return self.substitution_evaluator(element, context, file).evaluate(template)
        return None

    def condition(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> tuple[bool | None, frozenset[LaunchVariable]]:
        """Return what an element's condition says, None if it is not known, and what decides it."""
        results: list[bool | None] = []
        dependencies: set[LaunchVariable] = set()
        for key, expected in (("if", True), ("unless", False)):
            if key in element.attributes:
                results.append(None)
                text = self.value(element, key, context, file)
                dependencies |= self.dependencies
                with self.collect_errors(element, file):
                    results[-1] = None if text is None else parse_condition(text) is expected
        known = False if False in results else None if None in results else True
        return known, frozenset(dependencies)

    def remap_rules(
        self, elements: Iterable[Element], context: LaunchContext, file: FileInclusion
    ) -> list[RemapRule]:
        """Return the remap rules that elements say, `*` for a name that is not known."""
        rules = []
        for element in elements:
            self.limits.count_action(file.path, context)
            pair = [self.text(element, key, context, file) for key in ("from", "to")]
            rules.append((pair[0] or UNKNOWN_NAME, pair[1] or UNKNOWN_NAME))
        return rules

    def configurations(
        self, elements: Iterable[Element], context: LaunchContext, file: FileInclusion
    ) -> Iterator[tuple[LaunchVariable, str | None, frozenset[LaunchVariable]]]:
        """Yield the configurations that elements set, and what decides their values."""
        for element in elements:
            name = self.text(element, "name", context, file)
            value = self.value(element, "value", context, file)
            if name is not None:
                yield LaunchVariable(name), value, frozenset(self.dependencies)

    def substitution_evaluator(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> SubstitutionEvaluator:
        """Return what replaces substitutions in an element's texts."""
        functions = self._functions(context, file)
        if not self.symbolic:
            return SubstitutionEvaluator(functions)

        def failed(what: str, error: Exception) -> str:
            self.note_error(element, file, error)
            return placeholder(what)

        evaluator = SubstitutionEvaluator(functions, failed, max_length=MAX_GRAPH_TEXT)
        evaluator.context_view = self._context_view(element, context, file, evaluator)
        return evaluator

    def context_view(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> ContextView:
        """Return what a function of a Python launch file sees of the launch."""
        return self._context_view(
            element, context, file, self.substitution_evaluator(element, context, file)
        )

    def _context_view(
        self,
        element: Element,
        context: LaunchContext,
        file: FileInclusion,
        substitution: SubstitutionEvaluator,
    ) -> ContextView:
        note = partial(self.note, element, file)
        return ContextView(
            perform=substitution.evaluate, context=context, note=note, files=self.files
        )

    def _functions(self, context: LaunchContext, file: FileInclusion) -> Mapping[str, Function]:
        folder = os.path.dirname(file.path)  # noqa: PTH120 - a string in a string out

        def looked_up(
            function: Function, arguments: list[str], *, environment: bool = False
        ) -> str:
            looked_up_variable = LaunchVariable("".join(arguments[:1]), environment)
            self.dependencies |= context.dependencies_of(looked_up_variable)
            if looked_up_variable in context.unknown:
                raise UnresolvableError(f"the value of '{looked_up_variable.name}' is not known")
            return function(arguments)

        value = configuration_function(context.configurations)
        variable_value = environment_function(context.environ)
        return {
            "var": lambda words: looked_up(value, words),
            "env": lambda words: looked_up(variable_value, words, environment=True),
            "optenv": lambda words: looked_up(variable_value, [*words, ""][:2], environment=True),
            "dirname": lambda _: folder,
            "filename": lambda _: file.path,
            "anon": lambda words: f"{words[0]}_{UNKNOWN_NAME}",
            "config-equals": partial(_configuration_equals, context),
            "for-var": loop_variable(context.loops),
            "index": loop_variable(context.loops),
            "param": partial(_global_parameter, context),
            "node-name": lambda words: context.full_name(*words),
            **PackageLookup(
                self.environ, self.packages, self.symbolic, self.command_output
            ).functions(),
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

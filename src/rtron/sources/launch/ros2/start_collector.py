"""What a launch starts, taken with all that the graph of an app asks for."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.code.frontends.python.lowering import MAX_BYTES
from rtron.sources.launch.ros2.action_context import ActionContextTracker
from rtron.sources.launch.ros2.command_line import (
    argument_remaps,
    as_ros2_run,
    is_ros2_run,
    node_of_ros2_run,
    special_remap,
    split_template,
)
from rtron.sources.launch.ros2.inclusion import FileInclusion, element_location
from rtron.sources.launch.ros2.launch_context import LaunchContext, canonical_namespace
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES, ParameterSource
from rtron.sources.launch.ros2.parameters.node_configuration import NodeConfiguration
from rtron.sources.launch.ros2.result import DeclaredArgument, LaunchStart, StartKind
from rtron.sources.launch.ros2.shell import split_commands
from rtron.sources.launch.ros2.substitutions.template import display_text, has_placeholder
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

GLOBAL_PARAMETER_TAGS = frozenset({"set_parameter", "set_parameters_from_file"})
"""The actions that give parameters to all nodes after them."""

_KINDS = {
    "node": StartKind.NODE,
    "lifecycle_node": StartKind.LIFECYCLE_NODE,
    "node_container": StartKind.CONTAINER,
}


@dataclass(slots=True)
class StartCollector(ActionContextTracker):
    """Collects what a launch starts; `read_python_file` reads a Python launch file."""

    read_python_file: Callable[[str], Element] = field(kw_only=True)
    starts: list[LaunchStart] = field(default_factory=list)
    arguments: list[DeclaredArgument] = field(default_factory=list)

    def read_python(self, path: str) -> Element:
        """Return what a Python launch file describes; raise InputError where there is none."""
        if not path_exists(Path(path)) or not Path(path).is_file():
            raise InputError("is no file", path=path)
        if Path(path).stat().st_size > MAX_BYTES:
            raise InputError(f"larger than {MAX_BYTES // 2**20} MiB", path=path)
        return self.read_python_file(path)

    def add_node(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Take a node, and what is to be loaded into it."""
        start = self._node_start(element, context, file, _KINDS[element.tag])
        self.starts.append(start)
        self._add_components_of(element, context, file, start.full_name)

    def add_components(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Take the components that an action loads into a container."""
        target = self._display_text(element, "target", context, file) or UNKNOWN_NAME
        self._add_components_of(element, context, file, canonical_namespace(target))

    def _add_components_of(
        self, element: Element, context: LaunchContext, file: FileInclusion, container: str
    ) -> None:
        for component in element.children_named("composable_node"):
            holds, _ = self.evaluator.condition(component, context, file)
            if holds is not False:
                outer_uncertain = context.is_uncertain
                context.is_uncertain = context.is_uncertain or holds is None
                with self.under_condition(component, context, file, holds):
                    start = self._node_start(component, context, file, StartKind.COMPONENT)
                    extra = NodeConfiguration(self.evaluator, context, file).extra_arguments(
                        component
                    )
                    self.starts.append(replace(start, container=container, extra_arguments=extra))
                context.is_uncertain = outer_uncertain

    def add_executable(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Take a process, or each command of one that a shell runs; `ros2 run` starts a node."""
        words = self._attribute_words(as_ros2_run(element), "cmd", context, file)
        for command in split_commands(words, shell=element.plain_text("shell").lower() == "true"):
            self.evaluator.limits.count_node(file.path)
            self.starts.append(self._process_start(command, element, context, file))

    def _process_start(
        self, words: Sequence[str], element: Element, context: LaunchContext, file: FileInclusion
    ) -> LaunchStart:
        configuration = NodeConfiguration(self.evaluator, context, file)
        process = LaunchStart(
            kind=StartKind.PROCESS,
            arguments=tuple(map(display_text, words)),
            environ=configuration.environ(element),
            is_uncertain=context.is_uncertain,
            **self.context_fields(element, file),
        )
        return (
            _with_parameters(
                node_of_ros2_run(process), configuration.command_line_parameters(words, element)
            )
            if is_ros2_run(words)
            else process
        )

    def note_unknown(self, element: Element, file: FileInclusion) -> None:
        """Note an action of a kind that is not known."""
        self.evaluator.note(element, file, "is not known here: what it starts is not known")

    def note_not_included(
        self, element: Element, file_text: str | None, file: FileInclusion
    ) -> None:
        """Note that a file is not known which is included."""
        what = f"what it includes is not known: {display_text(file_text or '')}"
        self.evaluator.note(element, file, what)

    def add_global_parameters(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> None:
        """Give a parameter, or a file of them, to all nodes after this action."""
        source = NodeConfiguration(self.evaluator, context, file).global_parameters(element)
        if source is not None:
            context.add_parameters(source)

    def add_argument(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Take an argument that the root file declares."""
        if element.tag == "arg" and file.depth == 0:
            default = self._display_text(element, "default", context, file)
            argument = DeclaredArgument(
                name=element.plain_text("name"),
                default=default if "default" in element.attributes else None,
                description=element.plain_text("description"),
                evidence=element_location(element, file),
            )
            self.arguments.append(argument)

    def _node_start(
        self, element: Element, context: LaunchContext, file: FileInclusion, kind: StartKind
    ) -> LaunchStart:
        self.evaluator.limits.count_node(file.path)
        configuration = NodeConfiguration(self.evaluator, context, file)
        words = self._arguments(element, context, file)
        name, namespace = self._node_name(element, words, context, file)
        shared_remaps = [*argument_remaps(words), *(context.remaps or ())]
        remaps = self.evaluator.remap_rules(element.children_named("remap"), context, file)
        start = LaunchStart(
            kind=kind,
            package=self._display_text(element, "pkg", context, file),
            program=self._display_text(element, _program_attribute(kind), context, file),
            name=name,
            namespace=namespace or "/",
            has_namespace=bool(namespace),
            remaps=tuple(
                (display_text(name), display_text(target))
                for name, target in (*shared_remaps, *remaps)
            ),
            global_remap_count=len(shared_remaps),
            arguments=tuple(map(display_text, words)),
            environ=configuration.environ(element),
            is_uncertain=context.is_uncertain,
            **self.context_fields(element, file),
        )
        pattern = (
            start.full_name if name and namespace and kind is not StartKind.COMPONENT else ALL_NODES
        )
        node_parameters = configuration.node_parameters(element, pattern)
        argument_parameters = configuration.command_line_parameters(words, element)
        return _with_parameters(
            start, (*argument_parameters, *(context.parameters or ()), *node_parameters)
        )

    def _node_name(
        self, element: Element, words: Sequence[str], context: LaunchContext, file: FileInclusion
    ) -> tuple[str, str | None]:
        """Return a node's name and namespace, None for none; those in its arguments count first."""
        name = self._display_text(element, "name", context, file)
        has_namespace = "namespace" in element.attributes
        namespace_attribute = (
            self._display_text(element, "namespace", context, file) if has_namespace else None
        )
        namespace = context.node_namespace(namespace_attribute)
        full_or_base_name = special_remap(words, "__node") or special_remap(words, "__name") or name
        return full_or_base_name, special_remap(words, "__ns") or (
            namespace and display_text(namespace)
        )

    def _arguments(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> tuple[str, ...]:
        words = self._attribute_words(element, "args", context, file)
        ros = self._attribute_words(element, "ros_args", context, file)
        return (*words, "--ros-args", *ros) if ros else words

    def _attribute_words(
        self, element: Element, key: str, context: LaunchContext, file: FileInclusion
    ) -> tuple[str, ...]:
        """Return the words of an attribute, and of the elements that are a word each."""
        elements_values = [
            self.text_or_empty(child, "value", context, file)
            for child in element.children_named(key)
        ]
        substitution = self.evaluator.substitution_evaluator(element, context, file)
        with self.evaluator.collect_errors(element, file):
            template = substitution.parse(element.attributes.get(key, ""))
            return (
                *map(substitution.evaluate_template, split_template(template)),
                *elements_values,
            )
        return tuple(elements_values)

    def _display_text(
        self, element: Element, key: str, context: LaunchContext, file: FileInclusion
    ) -> str:
        return display_text(self.text_or_empty(element, key, context, file))


def _with_parameters(
    start: LaunchStart, parameter_sources: Iterable[ParameterSource]
) -> LaunchStart:
    """Return what starts with its parameters, and whether all of them are known."""
    sources = tuple(parameter_sources)
    complete = not any(has_placeholder(source.file) for source in sources)
    displayed = tuple(replace(source, file=display_text(source.file)) for source in sources)
    return replace(start, parameter_sources=displayed, parameters_complete=complete)


def _program_attribute(kind: StartKind) -> str:
    return "plugin" if kind is StartKind.COMPONENT else "exec"

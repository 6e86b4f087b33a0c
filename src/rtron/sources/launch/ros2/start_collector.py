"""What a launch starts, taken with all that the graph of an app asks for."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.code.frontends.python.lowering import MAX_BYTES
from rtron.sources.launch.ros2.command_line import (
    argument_remaps,
    as_ros2_run,
    is_ros2_run,
    node_of_ros2_run,
    special_remap,
    split_template,
)
from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.launch_context import canonical_namespace
from rtron.sources.launch.ros2.node_collector import LaunchCollector
from rtron.sources.launch.ros2.parameters.merge import ALL_NODES, ParameterSource
from rtron.sources.launch.ros2.parameters.node_configuration import NodeConfiguration
from rtron.sources.launch.ros2.result import DeclaredArgument, LaunchStart, StartKind
from rtron.sources.launch.ros2.shell import split_commands
from rtron.sources.launch.ros2.substitutions.template import display_text, has_placeholder
from rtron.sources.launch.ros2.xml_yaml import Element, read_ros1_syntax
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

GLOBAL_PARAMETER_TAGS = frozenset({"set_parameter", "set_parameters_from_file"})
"""The actions that give parameters to all nodes after them."""

_KINDS = {
    "node": StartKind.NODE,
    "lifecycle_node": StartKind.LIFECYCLE_NODE,
    "node_container": StartKind.CONTAINER,
}
_NAMES, _NAMESPACE = ("__node", "__name"), "__ns"
_NODE_NAMES = frozenset({*_NAMES, _NAMESPACE})
"""What rcl remaps beside topics: the name and the namespace of a node."""


@dataclass(slots=True)
class StartCollector(LaunchCollector):
    """Collects what a launch starts; `read_python_file` reads a Python launch file."""

    unknown_action = "is not known here: what it starts is not known"
    read_python_file: Callable[[str], Element]
    starts: list[LaunchStart] = field(default_factory=list)
    arguments: list[DeclaredArgument] = field(default_factory=list)

    def accept(self, root: Element, path: str) -> Element:
        """Return a file with ROS 1's syntax in it noted, and read as it is meant."""
        translated, notes = read_ros1_syntax(root, path)
        self.evaluator.unresolved.extend(notes)
        return translated

    def read_python(self, path: str) -> Element:
        """Return what a Python launch file describes; raise InputError where there is none."""
        if not path_exists(Path(path)) or not Path(path).is_file():
            raise InputError("is no file", path=path)
        if Path(path).stat().st_size > MAX_BYTES:
            raise InputError(f"larger than {MAX_BYTES // 2**20} MiB", path=path)
        return self.read_python_file(path)

    def add_node(self, site: ElementSite) -> str:
        """Take a node; return its full name."""
        start = self._node_start(site, _KINDS[site.tag])
        self.starts.append(start)
        return start.full_name

    def add_component(self, site: ElementSite, container: str) -> None:
        """Take a component that a container loads."""
        start = self._node_start(site, StartKind.COMPONENT)
        extra = NodeConfiguration(self.evaluator, site).extra_arguments()
        self.starts.append(replace(start, container=container, extra_arguments=extra))

    def container_name(self, site: ElementSite) -> str:
        """Return the full name of the container that an action loads components into."""
        return canonical_namespace(self._display_text(site, "target") or UNKNOWN_NAME)

    def add_executable(self, site: ElementSite) -> None:
        """Take a process, or each command of one that a shell runs; `ros2 run` starts a node."""
        words = self._attribute_words(site.at(as_ros2_run(site.element)), "cmd")
        for command in split_commands(words, shell=site.plain_text("shell").lower() == "true"):
            self.evaluator.limits.count_node(site.file.path)
            self.starts.append(self._process_start(command, site))

    def note_not_included(self, site: ElementSite, path: str | None) -> None:
        """Note an inclusion whose file is not known."""
        self.evaluator.note(site, f"what it includes is not known: {path or ''}")

    def add_global_parameters(self, site: ElementSite) -> None:
        """Give a parameter, or a file of them, to all nodes after this action."""
        source = NodeConfiguration(self.evaluator, site).global_parameters()
        if source is not None:
            site.context.add_parameters(source)

    def add_argument(self, site: ElementSite) -> None:
        """Take an argument that the root file declares."""
        if site.tag == "arg" and site.file.depth == 0:
            default = self._display_text(site, "default")
            argument = DeclaredArgument(
                name=site.plain_text("name"),
                default=default if site.has("default") else None,
                evidence=site.location,
            )
            self.arguments.append(argument)

    def _process_start(self, words: Sequence[str], site: ElementSite) -> LaunchStart:
        configuration = NodeConfiguration(self.evaluator, site)
        process = LaunchStart(
            kind=StartKind.PROCESS,
            arguments=tuple(map(display_text, words)),
            environ=configuration.environ(),
            is_uncertain=site.context.is_uncertain,
            evidence=site.location,
        )
        if not is_ros2_run(words):
            return process
        parameters = configuration.command_line_parameters(words)
        return _with_parameters(node_of_ros2_run(process), parameters)

    def _node_start(self, site: ElementSite, kind: StartKind) -> LaunchStart:
        self.evaluator.limits.count_node(site.file.path)
        configuration = NodeConfiguration(self.evaluator, site)
        words = self._arguments(site)
        rules = (*(site.context.remaps or ()), *self.evaluator.remap_rules(site.children("remap")))
        name, namespace = self._node_name(site, words, dict(reversed(rules)))
        remaps = (*argument_remaps(words), *(rule for rule in rules if rule[0] not in _NODE_NAMES))
        start = LaunchStart(
            kind=kind,
            package=self._display_text(site, "pkg"),
            program=self._display_text(site, _program_attribute(kind)),
            name=name,
            namespace=namespace or "/",
            has_namespace=bool(namespace),
            remaps=tuple((display_text(source), display_text(to)) for source, to in remaps),
            arguments=tuple(map(display_text, words)),
            environ=configuration.environ(),
            is_uncertain=site.context.is_uncertain,
            evidence=site.location,
        )
        is_named = name and namespace and kind is not StartKind.COMPONENT
        node_parameters = configuration.node_parameters(start.full_name if is_named else ALL_NODES)
        argument_parameters = configuration.command_line_parameters(words)
        return _with_parameters(
            start, (*argument_parameters, *(site.context.parameters or ()), *node_parameters)
        )

    def _node_name(
        self, site: ElementSite, words: Sequence[str], remaps: Mapping[str, str]
    ) -> tuple[str, str | None]:
        """Return a node's name and namespace, None for none.

        Those in its arguments count first. Of its attributes launch writes the name before the
        remaps, and the namespace behind them.
        """
        named = (special_remap(words, key) for key in _NAMES)
        renamed = (display_text(remaps[key]) for key in _NAMES if key in remaps)
        name = next(filter(None, (*named, self._display_text(site, "name"), *renamed)), "")
        attribute = self._display_text(site, "namespace") if site.has("namespace") else None
        namespace = remaps.get(_NAMESPACE, site.context.node_namespace(attribute))
        return name, special_remap(words, _NAMESPACE) or (namespace and display_text(namespace))

    def _arguments(self, site: ElementSite) -> tuple[str, ...]:
        """Return the words of a node's command line; of an installed file, its source."""
        locate = self.evaluator.files.locate_source
        given = self._attribute_words(site, "args")
        words = tuple(locate(word) if word.startswith("/") else word for word in given)
        ros = self._attribute_words(site, "ros_args")
        return (*words, "--ros-args", *ros) if ros else words

    def _attribute_words(self, site: ElementSite, key: str) -> tuple[str, ...]:
        """Return the words of an attribute, and of the elements that are a word each."""
        values = [self.evaluator.value(child, "value") or "" for child in site.children(key)]
        substitution = self.evaluator.substitution_evaluator(site)
        with self.evaluator.collect_errors(site):
            template = substitution.parse(site.element.attributes.get(key, ""))
            return (*map(substitution.evaluate_template, split_template(template)), *values)
        return tuple(values)

    def _display_text(self, site: ElementSite, key: str) -> str:
        return display_text(self.evaluator.value(site, key) or "")


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

"""The actions of ROS 2's launch files that start nothing: what they change for all after them."""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.inclusion import FileInclusion
from rtron.sources.launch.ros2.launch_context import NAMESPACE, LaunchContext, LaunchVariable
from rtron.sources.launch.ros2.substitutions.template import placeholder
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary.remap_rules import UNKNOWN_NAME

NAMESPACE_TAGS = frozenset({"push_ros_namespace", "push-ros-namespace"})

CONTEXT_TAGS = NAMESPACE_TAGS | {
    "arg",
    "let",
    "unset",
    "set_remap",
    "reset",
    "set_env",
    "unset_env",
    "append_env",
    "reset_env",
}
"""What changes the scope for all that comes after it."""

IGNORED_TAGS = frozenset(
    {
        "log",
        "log_debug",
        "log_info",
        "log_warning",
        "log_error",
        "shutdown",
        "set_parameter",
        "set_parameters_from_file",
        "set_ros_log_dir",
        "set_use_sim_time",
        "lifecycle_transition",
    }
)
"""What neither starts a node nor changes a name."""


@dataclass(slots=True)
class ContextActions:
    """Applies actions that change the scope."""

    evaluator: LaunchEvaluator

    def apply(
        self,
        element: Element,
        context: LaunchContext,
        file: FileInclusion,
        holds: bool | None,  # noqa: FBT001
    ) -> None:
        """Apply an action of SETTINGS; `holds` is what its condition says, None if not known."""
        if holds is not None or not self.evaluator.symbolic:
            self._apply(element, context, file)
            return
        values_before = dict(context.configurations), dict(context.environ)
        self._apply(element, context, file)
        for values, previous in zip(
            (context.configurations, context.environ), values_before, strict=True
        ):
            changed = [name for name in values if values[name] != previous.get(name)]
            values.update({name: placeholder(name) for name in changed})

    def _apply(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        tag = element.tag
        if tag == "arg":
            self._argument(element, context, file)
        elif tag == "let":
            self.set_configuration(element, context, file)
        elif tag in NAMESPACE_TAGS:
            pushed = self.evaluator.text(element, "namespace", context, file)
            namespace = context.node_namespace(UNKNOWN_NAME if pushed is None else pushed)
            source = LaunchVariable(NAMESPACE)
            context.set_value(
                source,
                None if namespace == UNKNOWN_NAME else namespace,
                context.dependencies_of(source),
            )
        elif tag == "set_remap":
            context.add_remaps(self.evaluator.remap_rules([element], context, file))
        elif tag == "reset":
            preserved_values = list(self.preserved_configurations(element, context, file))
            context.clear()
            for item in preserved_values:
                context.set_value(*item)
        elif tag == "unset":
            name = self.evaluator.text(element, "name", context, file)
            context.configurations.pop(name or "", None)
        elif tag == "reset_env":
            context.reset_environment(self.evaluator.environ)
        else:
            self._environment_variable(element, context, file)

    def set_configuration(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> None:
        """Set a configuration."""
        for item in self.evaluator.configurations([element], context, file):
            context.set_value(*item)

    def preserved_configurations(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> Iterator[tuple[LaunchVariable, str | None, frozenset[LaunchVariable]]]:
        """Yield the configurations that a group or a reset keeps."""
        return self.evaluator.configurations(element.children_named("keep"), context, file)

    def _environment_variable(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> None:
        name = self.evaluator.text(element, "name", context, file)
        if name is None:
            return
        value = self.evaluator.value(element, "value", context, file)
        dependencies = frozenset(self.evaluator.dependencies)
        variable = LaunchVariable(name, is_environment=True)
        if element.tag == "unset_env":
            context.set_value(variable, None)
            context.unknown.discard(variable)
        elif element.tag == "set_env":
            context.set_value(variable, value, dependencies)
        else:
            longer = self._appended_value(element, context, name, value)
            context.set_value(variable, longer, dependencies | context.dependencies_of(variable))

    def _appended_value(
        self, element: Element, context: LaunchContext, name: str, value: str | None
    ) -> str | None:
        """Return what `append_env` makes of a variable, where that is asked for."""
        if not self.evaluator.symbolic or value is None:
            return None
        words = [word for word in (context.environ.get(name), value) if word]
        first = element.plain_text("prepend").lower() in {"true", "1", "yes"}
        return (element.plain_text("separator") or ":").join(words[::-1] if first else words)

    def _argument(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        source = LaunchVariable(element.plain_text("name"))
        if source.name in context.configurations or source in context.unknown:
            return
        if "default" not in element.attributes:
            self._missing_argument(element, source, context, file)
            return
        value = self.evaluator.value(element, "default", context, file)
        self.evaluator.choices.add_default(source.name, value)
        context.set_value(source, value, {source, *self.evaluator.dependencies})

    def _missing_argument(
        self, element: Element, source: LaunchVariable, context: LaunchContext, file: FileInclusion
    ) -> None:
        """Take an argument that nobody gave for a hole, if holes may be."""
        if not self.evaluator.symbolic:
            raise MissingArgumentError(source.name)
        self.evaluator.note_missing(element, file, source.name)
        context.set_value(source, placeholder(source.name), {source})

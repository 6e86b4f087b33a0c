"""The nodes of a launch file as the guarded launch needs them: each with its element's place."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from rtron.sources.launch.ros2.action_context import ActionContext
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.inclusion import FileInclusion
from rtron.sources.launch.ros2.launch_context import NAMESPACE, LaunchContext, LaunchVariable
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import GUARD_NODE, LaunchNode
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, RemapRule, parse_remap_rules, remaps_for_node

_NOT_REMAPPED = "is no `node`: what it starts gets no remaps"


@dataclass(slots=True)
class LaunchNodeCollector:
    """Takes what a launch starts into the tree of its files; Python files are not looked into."""

    _evaluator: LaunchEvaluator

    def read_python(self, path: str) -> None:
        """Leave a Python launch file as it is."""

    def add_node(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Take a node, and what is to be loaded into it."""
        file.nodes.append(self._launch_node(element, context, file, "exec"))
        if element.tag == "node_container":
            self.add_components(element, context, file)

    def add_components(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Take the components that an action loads."""
        for component in element.children_named("composable_node"):
            holds, dependencies = self._evaluator.condition(component, context, file)
            if holds is False:
                self._evaluator.choices.decide(dependencies)
            else:
                outer_uncertain = context.is_uncertain
                context.is_uncertain = context.is_uncertain or holds is None
                file.nodes.append(self._launch_node(component, context, file, "plugin"))
                context.is_uncertain = outer_uncertain

    def add_executable(self, element: Element, _: LaunchContext, file: FileInclusion) -> None:
        """Note a process that is no `<node>`: only at run time can a node in it be seen."""
        if element.attributes.get("name") == GUARD_NODE.strip("/"):
            guard = LaunchNode(name=GUARD_NODE, package="", type="", element_index=element.position)
            file.nodes.append(guard)
        else:
            self._evaluator.note(element, file, _NOT_REMAPPED)

    def note_unknown(self, element: Element, file: FileInclusion) -> None:
        """Note an action of a kind that is not known."""
        self._evaluator.note(element, file, "is not known here; what it starts gets no remaps")

    def note_not_included(
        self, element: Element, file_text: str | None, file: FileInclusion
    ) -> None:
        """Leave an inclusion whose file has no value here: that is noted already."""

    def add_global_parameters(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> None:
        """Leave parameters, which change no name."""

    def add_argument(self, element: Element, context: LaunchContext, file: FileInclusion) -> None:
        """Leave arguments to the choices."""

    def event_context(self, _: Element) -> ActionContext:
        """Return what surrounds an action, which is not asked for here."""
        return ActionContext()

    @contextmanager
    def in_context(self, _: ActionContext) -> Iterator[None]:
        """Read what runs later."""
        yield

    @contextmanager
    def under_condition(
        self,
        _: Element,
        __: LaunchContext,
        ___: FileInclusion,
        ____: bool | None,  # noqa: FBT001
    ) -> Iterator[None]:
        """Read an action under its condition."""
        yield

    @contextmanager
    def within_include(
        self, _: Element, __: str, ___: LaunchContext, ____: FileInclusion
    ) -> Iterator[None]:
        """Read an included file."""
        yield

    def _launch_node(
        self, element: Element, context: LaunchContext, file: FileInclusion, type_attribute: str
    ) -> LaunchNode:
        """Return a node, or a component; a name that is not known is a `*`."""
        self._evaluator.limits.count_node(file.path)
        namespace = self._evaluator.text(element, "namespace", context, file)
        has_namespace = "namespace" in element.attributes
        base = self._evaluator.text(element, "name", context, file) or UNKNOWN_NAME
        name = context.full_name(
            base, UNKNOWN_NAME if has_namespace and namespace is None else namespace
        )
        self._evaluator.choices.decide(context.dependencies_of(LaunchVariable(NAMESPACE)))
        args, argument_rules = self._command_line_remaps(element, context, file)
        shared = tuple(remaps_for_node([*argument_rules, *(context.remaps or ())], name))
        rules = remaps_for_node(
            self._evaluator.remap_rules(element.children_named("remap"), context, file), name
        )
        return LaunchNode(
            name=name,
            package=element.plain_text("pkg"),
            type=element.plain_text(type_attribute),
            args=args,
            remaps=(*shared, *rules),
            element_index=element.position,
            line=element.line,
            anonymous=UNKNOWN_NAME in name,
            conditional=context.is_uncertain,
            inherited_remap_count=len(shared),
        )

    def _command_line_remaps(
        self, element: Element, context: LaunchContext, file: FileInclusion
    ) -> tuple[str, list[RemapRule]]:
        """Return a node's arguments, and the rules in them, which count before all others."""
        args = self._evaluator.value(element, "args", context, file) or ""
        dependencies = set(self._evaluator.dependencies)
        ros = self._evaluator.value(element, "ros_args", context, file) or ""
        rules = [
            *parse_remap_rules(args, in_ros_args=False),
            *parse_remap_rules(ros, in_ros_args=True),
        ]
        self._evaluator.choices.decide(dependencies | self._evaluator.dependencies if rules else ())
        return args, rules

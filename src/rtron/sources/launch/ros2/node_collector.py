"""The nodes of a launch file for the guarded launch: each with the index of its element."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.launch_context import NAMESPACE, LaunchVariable
from rtron.sources.launch.ros2.xml_yaml import Element
from rtron.vocabulary import GUARD_NODE, LaunchNode
from rtron.vocabulary.enums import HiddenPart
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, RemapRule, parse_remap_rules, remaps_for_node


@dataclass(slots=True)
class LaunchCollector(ABC):
    """Takes what a launch starts; a method that a subclass does not override does nothing."""

    evaluator: LaunchEvaluator
    unknown_action: ClassVar[str]
    """The note on an action of a kind that is not known."""

    @abstractmethod
    def add_node(self, site: ElementSite) -> str:
        """Take a node; return its full name."""

    @abstractmethod
    def add_component(self, site: ElementSite, container: str) -> None:
        """Take a component that the container of this name loads."""

    @abstractmethod
    def add_executable(self, site: ElementSite) -> None:
        """Take a process."""

    def container_name(self, _: ElementSite) -> str:
        """Return the full name of the container that an action loads components into."""
        return ""

    def accept(self, root: Element, _: str) -> Element:
        """Return what is read of an XML or YAML file, the second argument."""
        return root

    def read_python(self, _: str) -> Element | None:
        """Return what a Python launch file describes, None where it is not looked into."""
        return None

    def note_unknown(self, site: ElementSite) -> None:
        """Note an action of a kind that is not known."""
        self.evaluator.note(site, self.unknown_action, hides=HiddenPart.NODES)

    def note_not_included(self, _: ElementSite, __: str | None) -> None:  # noqa: B027 - a choice
        """Take an inclusion whose file, the second argument, is not known."""

    def add_global_parameters(self, _: ElementSite) -> None:  # noqa: B027 - a choice
        """Take a parameter, or a file of them, for all nodes after this action."""

    def add_argument(self, _: ElementSite) -> None:  # noqa: B027 - a choice
        """Take an argument that a file declares."""


_NOT_REMAPPED = "is no `node`: what it starts gets no remaps"


@dataclass(slots=True)
class LaunchNodeCollector(LaunchCollector):
    """Takes what a launch starts into the tree of its files; Python files are not looked into."""

    unknown_action = "is not known here; what it starts gets no remaps"

    def add_node(self, site: ElementSite) -> str:
        """Take a node; return its full name."""
        return self._add(site, "exec")

    def add_component(self, site: ElementSite, _: str) -> None:
        """Take a component."""
        self._add(site, "plugin")

    def add_executable(self, site: ElementSite) -> None:
        """Note a process that is no `<node>`: only at run time can a node in it be seen."""
        if site.element.attributes.get("name") == GUARD_NODE.strip("/"):
            index = site.element.position
            site.file.nodes.append(
                LaunchNode(name=GUARD_NODE, package="", type="", element_index=index)
            )
        else:
            self.evaluator.note(site, _NOT_REMAPPED)

    def _add(self, site: ElementSite, type_attribute: str) -> str:
        """Take a node or a component; a name that is not known is a `*`."""
        self.evaluator.limits.count_node(site.file.path)
        name = self._full_name(site)
        args, argument_rules = self._command_line_remaps(site)
        shared = tuple(remaps_for_node([*argument_rules, *(site.context.remaps or ())], name))
        rules = remaps_for_node(self.evaluator.remap_rules(site.children("remap")), name)
        node = LaunchNode(
            name=name,
            package=site.plain_text("pkg"),
            type=site.plain_text(type_attribute),
            args=args,
            remaps=(*shared, *rules),
            element_index=site.element.position,
            line=site.element.line,
            anonymous=UNKNOWN_NAME in name,
            conditional=site.context.is_uncertain,
            inherited_remap_count=len(shared),
        )
        site.file.nodes.append(node)
        return name

    def _full_name(self, site: ElementSite) -> str:
        namespace = self.evaluator.text(site, "namespace")
        if namespace is None and site.has("namespace"):
            namespace = UNKNOWN_NAME
        base = self.evaluator.text(site, "name") or UNKNOWN_NAME
        self.evaluator.choices.decide(site.context.dependencies_of(LaunchVariable(NAMESPACE)))
        return site.context.full_name(base, namespace)

    def _command_line_remaps(self, site: ElementSite) -> tuple[str, list[RemapRule]]:
        """Return a node's arguments, and the rules in them, which count before all others."""
        args = self.evaluator.value(site, "args") or ""
        dependencies = set(self.evaluator.dependencies)
        ros = self.evaluator.value(site, "ros_args") or ""
        rules = [
            *parse_remap_rules(args, in_ros_args=False),
            *parse_remap_rules(ros, in_ros_args=True),
        ]
        self.evaluator.choices.decide(dependencies | self.evaluator.dependencies if rules else ())
        return args, rules

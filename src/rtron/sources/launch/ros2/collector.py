"""What takes the actions of a launch while its files are read."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary.enums import HiddenPart


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

"""A launch file of ROS 2 as elements, whether it was written in XML, YAML or Python."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.substitutions.template import TemplateText


@dataclass(frozen=True, slots=True)
class Element:
    """An action of a launch file, or what belongs to one.

    `position` counts the elements of an XML text in document order, the root being 0; in YAML it is
    where the element's value begins in the text, in characters. `file` is empty where it is that of
    the launch itself. `expand` calls a function of a Python launch file, for the actions it
    returns.
    """

    tag: str
    attributes: Mapping[str, TemplateText]
    children: tuple["Element", ...] = ()
    position: int = 0
    line: int = 0
    file: str = ""
    expand: Callable[[ContextView], tuple["Element", ...]] | None = None

    def children_named(self, tag: str) -> Iterator["Element"]:
        """Yield the children of one kind."""
        return (child for child in self.children if child.tag == tag)

    def with_location(self, line: int, file: str) -> "Element":
        """Return it, and what is in it, at a line of a file where they have no place yet."""
        children = tuple(child.with_location(line, file) for child in self.children)
        return replace(self, children=children, line=self.line or line, file=self.file or file)

    def plain_text(self, key: str) -> str:
        """Return an attribute as it is written; empty where it is not plain text."""
        text = self.attributes.get(key, "")
        if isinstance(text, str):
            return text
        return "".join(part for part in text if isinstance(part, str))

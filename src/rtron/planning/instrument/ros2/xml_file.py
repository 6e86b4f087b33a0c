"""An XML launch file of ROS 2, to be changed."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr, unescape

from rtron.errors import InputError
from rtron.planning.instrument.launch_text import LaunchText
from rtron.planning.instrument.ros2.launch_file import Rule, early
from rtron.planning.instrument.source_text import in_utf8
from rtron.planning.instrument.spans import Span, spans

_DIRNAME = re.compile(rb"\$\( *dirname *\)")
_FILENAME = re.compile(rb"\$\( *filename *\)")
_QUOTES = {"&quot;": '"', "&apos;": "'"}


def xml_file(path: str, folder: str) -> "XmlFile":
    """Read a file so that a copy elsewhere still means `folder` by `$(dirname)`.

    Raise InputError if it cannot be read, is not XML or has a document type.
    """
    text = _DIRNAME.sub(lambda _: folder.encode(), in_utf8(path))
    text = _FILENAME.sub(lambda _: path.encode(), text)
    return XmlFile(path, LaunchText(text=text, elements=spans(text, path)))


@dataclass(frozen=True, slots=True)
class XmlFile:
    """See LaunchFileText; places count elements."""

    path: str
    text: LaunchText

    def own_rules(self, place: int) -> int:
        """Count the `<remap>` in a node."""
        node = self._element(place)
        inside = (e for e in self.text.elements if node.start < e.start < node.close)
        return sum(element.tag == "remap" for element in self._children(inside, node))

    def _children(self, inside: Iterator[Span], node: Span) -> Iterator[Span]:
        """Yield the elements that lie directly in a node."""
        end = node.start
        for element in inside:
            if element.start >= end:
                yield element
                end = element.close

    def remap(self, place: int, rules: Sequence[Rule]) -> None:
        """Put `<remap>` first into a node."""
        lines = [f"<remap from={quoteattr(a)} to={quoteattr(b)}/>" for a, b in rules]
        self.text.prepend(self._element(place), lines)

    def remap_early(self, place: int, rules: Sequence[Rule]) -> None:
        """Put remaps into a node's `args`."""
        node = self._element(place)
        written = self.text.attribute(node, "args")
        if written is None:
            self.text.add_attribute(node, "args", early(rules, ""))
        else:
            args = unescape(written[1:-1], _QUOTES)
            self.text.set_attribute(node, "args", early(rules, args))

    def loads(self, place: int) -> bool:
        """Tell whether it is a `<composable_node>`."""
        return self._element(place).tag == "composable_node"

    def lead(self, place: int, file: str) -> None:
        """Change an include's `file`."""
        self.text.set_attribute(self._element(place), "file", file)

    def start(self, command: str, name: str) -> None:
        """Put an `<executable>` first."""
        words = f"cmd={quoteattr(command)} name={quoteattr(name)}"
        self.text.prepend(
            self.text.elements[0], [f'<executable {words} output="screen" respawn="true"/>']
        )

    def changed(self) -> str:
        """Return the text with all changes made."""
        return self.text.changed()

    def _element(self, place: int) -> Span:
        if place >= len(self.text.elements):
            raise InputError("has changed since it was read", path=self.path, help="start again")
        return self.text.elements[place]

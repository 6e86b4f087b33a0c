"""An XML launch file of ROS 2, to be changed."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr, unescape

from rtron.errors import InputError
from rtron.planning.instrument.common.xml_spans import Span, spans
from rtron.planning.instrument.common.xml_text import LaunchText
from rtron.planning.instrument.ros1.source_text import PLAIN, in_utf8
from rtron.planning.instrument.ros2.launch_file import Rule, Start, early

_DIRNAME = re.compile(rb"\$\( *dirname *\)")
_FILENAME = re.compile(rb"\$\( *filename *\)")
_QUOTES = {"&quot;": '"', "&apos;": "'"}


def xml_file(path: str, folder: str) -> "XmlFile":
    """Read a file so that a copy elsewhere still means `folder` by `$(dirname)`.

    Raise InputError if it cannot be read, is not XML or has a document type.
    """
    text = in_utf8(path)
    if not PLAIN.fullmatch(path) and (_DIRNAME.search(text) or _FILENAME.search(text)):
        raise InputError("lies in a folder whose name cannot stand in a launch file", path=path)
    text = _DIRNAME.sub(lambda _: folder.encode(), text)
    text = _FILENAME.sub(lambda _: path.encode(), text)
    return XmlFile(path, LaunchText(text=text, elements=spans(text, path)))


@dataclass(frozen=True, slots=True)
class XmlFile:
    """See LaunchFileText; places count elements."""

    path: str
    text: LaunchText

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

    def start(self, here: Start, *, script: str, name: str, check: str) -> None:
        """Put a `<let>`, an `<include>` and an `<executable>` first."""
        words = f"cmd={quoteattr(here / script)} name={quoteattr(name)}"
        first = (
            f"<let name={quoteattr(here.variable)} value={quoteattr(here.folder)}/>",
            f"<include file={quoteattr(here / check)}/>",
            f'<executable {words} output="screen" respawn="true"/>',
        )
        self.text.prepend(self.text.elements[0], first)

    def changed(self) -> str:
        """Return the text with all changes made."""
        return self.text.changed()

    def _element(self, place: int) -> Span:
        if place >= len(self.text.elements):
            raise InputError("has changed since it was read", path=self.path, help="start again")
        return self.text.elements[place]

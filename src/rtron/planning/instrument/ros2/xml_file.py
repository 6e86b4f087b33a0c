"""An XML launch file of ROS 2, to be changed."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr, unescape

from rtron.errors import InputError
from rtron.planning.instrument.common.xml_text import (
    PLAIN_TEXT,
    ElementSpan,
    LaunchText,
    find_elements,
    read_utf8,
)
from rtron.planning.instrument.ros2.launch_file import GuardedFolder, RemapPair, prepend_remaps

_DIRNAME = re.compile(rb"\$\( *dirname *\)")
_FILENAME = re.compile(rb"\$\( *filename *\)")
_QUOTES = {"&quot;": '"', "&apos;": "'"}


def xml_file(path: str, folder: str) -> "XmlFile":
    """Read a file so that a copy elsewhere still means `folder` by `$(dirname)`.

    Raise InputError if it cannot be read, is not XML or has a document type.
    """
    text = read_utf8(path)
    if not PLAIN_TEXT.fullmatch(path) and (_DIRNAME.search(text) or _FILENAME.search(text)):
        raise InputError("lies in a folder whose name cannot stand in a launch file", path=path)
    text = _DIRNAME.sub(lambda _: folder.encode(), text)
    text = _FILENAME.sub(lambda _: path.encode(), text)
    return XmlFile(path, LaunchText(text=text, elements=find_elements(text, path)))


@dataclass(frozen=True, slots=True)
class XmlFile:
    """See LaunchFileText; places count elements."""

    path: str
    text: LaunchText

    def add_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put `<remap>` first into a node."""
        lines = [f"<remap from={quoteattr(a)} to={quoteattr(b)}/>" for a, b in rules]
        self.text.prepend(self._element(index), lines)

    def add_early_remaps(self, index: int, rules: Sequence[RemapPair]) -> None:
        """Put remaps into a node's `args`."""
        node = self._element(index)
        written = self.text.attribute(node, "args")
        if written is None:
            self.text.add_attribute(node, "args", prepend_remaps(rules, ""))
        else:
            args = unescape(written[1:-1], _QUOTES)
            self.text.set_attribute(node, "args", prepend_remaps(rules, args))

    def is_component(self, index: int) -> bool:
        """Tell whether it is a `<composable_node>`."""
        return self._element(index).tag == "composable_node"

    def redirect_include(self, index: int, file: str) -> None:
        """Change an include's `file`."""
        self.text.set_attribute(self._element(index), "file", file)

    def add_guard(self, folder: GuardedFolder, *, script: str, name: str, check: str) -> None:
        """Put a `<let>`, an `<include>` and an `<executable>` first."""
        process = f"cmd={quoteattr(folder / script)} name={quoteattr(name)}"
        variable = f"name={quoteattr(folder.variable)} value={quoteattr(folder.folder)}"
        first = (
            f"<let {variable}/>",
            f"<include file={quoteattr(folder / check)}/>",
            f'<executable {process} output="screen" respawn="true"/>',
        )
        self.text.prepend(self.text.elements[0], first)

    def render(self) -> str:
        """Return the text with all changes made."""
        return self.text.render()

    def _element(self, index: int) -> ElementSpan:
        if index >= len(self.text.elements):
            raise InputError("has changed since it was read", path=self.path, help="start again")
        return self.text.elements[index]

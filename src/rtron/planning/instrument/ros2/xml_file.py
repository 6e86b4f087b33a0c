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
from rtron.planning.instrument.ros2.launch_file import (
    PREFIX,
    GuardedFolder,
    GuardStart,
    RemapPair,
    prepend_remaps,
)

_DIRNAME = re.compile(rb"\$\( *dirname *\)")
_FILENAME = re.compile(rb"\$\( *filename *\)")
_COMPONENTS = frozenset({"composable_node", "composable_lifecycle_node"})
_LOG_NAME = "exec_name"
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
        """Tell whether it is a `<composable_node>`, or one with a lifecycle."""
        return self._element(index).tag in _COMPONENTS

    def start_through(self, index: int, prefix: str, name: str) -> None:
        """Put a prefix into `launch-prefix`, and a name into `exec_name` if there is none."""
        if self.is_component(index):
            return
        node = self._element(index)
        own = self.text.attribute(node, PREFIX)
        if own is None:
            self.text.add_attribute(node, PREFIX, prefix)
        else:
            self.text.set_attribute(node, PREFIX, f"{prefix} {unescape(own[1:-1], _QUOTES)}")
        if self.text.attribute(node, _LOG_NAME) is None:
            self.text.add_attribute(node, _LOG_NAME, name)

    def redirect_include(self, index: int, file: str) -> None:
        """Change an include's `file`."""
        self.text.set_attribute(self._element(index), "file", file)

    def add_guard(self, folder: GuardedFolder, guard: GuardStart) -> None:
        """Put variables, a `<let>`, an `<include>` and an `<executable>` first."""
        cmd, name = quoteattr(folder / guard.script), quoteattr(guard.name)
        first = [
            *(_named("set_env", *each) for each in guard.environment.items()),
            _named("let", folder.variable, folder.folder),
            f"<include file={quoteattr(folder / guard.check)}/>",
            f'<executable cmd={cmd} name={name} output="screen" respawn="true"/>',
            *([_named("let", PREFIX, folder / guard.prefix)] if guard.prefix else []),
        ]
        self.text.prepend(self.text.elements[0], first)

    def render(self) -> str:
        """Return the text with all changes made."""
        return self.text.render()

    def _element(self, index: int) -> ElementSpan:
        if index >= len(self.text.elements):
            raise InputError("has changed since it was read", path=self.path, help="start again")
        return self.text.elements[index]


def _named(tag: str, name: str, value: str) -> str:
    return f"<{tag} name={quoteattr(name)} value={quoteattr(value)}/>"

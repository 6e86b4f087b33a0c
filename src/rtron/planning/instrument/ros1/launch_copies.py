"""The guarded launch's own files: the launch file and those of its includes that change."""

import os.path
import re
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import TypeAlias
from xml.sax.saxutils import quoteattr

from rtron.errors import InputError
from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.remaps import Wiring
from rtron.planning.instrument.common.xml_spans import Span
from rtron.planning.instrument.common.xml_text import LaunchText
from rtron.planning.instrument.ros1.include import lead
from rtron.planning.instrument.ros1.launch_prefix_script import STARTER
from rtron.planning.instrument.ros1.prefix import prefix
from rtron.planning.instrument.ros1.source_text import source_text
from rtron.vocabulary import LaunchFile, LaunchNode

Edits: TypeAlias = tuple[object, ...]

_NODES = ("node", "test")
_ODD = re.compile(r"[^\w.-]")


@dataclass(slots=True)
class Copies:
    """Makes changed copies of launch files; `texts` maps each copy's name to its text.

    Every inclusion has its own copy, as the nodes of each have other names. `starters` are the
    nodes that start launch files; they get a launch-prefix.
    """

    wiring: Wiring
    starters: Collection[str] = ()
    texts: dict[str, str] = field(default_factory=dict)

    def root(self, file: LaunchFile, folder: str, guard: Collection[str]) -> str:
        """Return the launch file's text with the guard; the copies lie beside it in `folder`."""
        text = self._changed(file, f"/{folder}")
        launch = next(element for element in text.elements if element.tag == "launch")
        text.prepend(launch, tuple(guard))
        return text.changed()

    def started(self, file: LaunchFile, here: str) -> str:
        """Return the text of a launch file that a node starts; `here` leads to the copies."""
        return self._changed(file, here).changed()

    def changes(self, file: LaunchFile) -> bool:
        """Tell whether a launch file, or one below it, is to be changed."""
        return any(self._edits(node) for below in file.walk() for node in below.nodes)

    def edits(self, file: LaunchFile) -> Edits:
        """Return all changes of a launch file and those below it, to be compared."""
        nodes = ((node.element, self._edits(node)) for node in file.nodes)
        includes = (
            (i.element, i.spelled, self.edits(i.file))
            for i in file.includes
            if self.changes(i.file)
        )
        return (*(edit for edit in nodes if edit[1]), *includes)

    def _changed(self, file: LaunchFile, here: str) -> LaunchText:
        """Return a file with its remaps, and its includes led to their copies.

        `here` is what leads from the folder of the file's copy to the others.
        """
        text = source_text(file.path, _dirname(file.path))
        for node in file.nodes:
            remaps = self._remaps(node)
            if remaps:
                text.append(_element(text, file, node.element, _NODES), remaps)
            if node.name in self.starters:
                prefix(text, _element(text, file, node.element, _NODES), f"{here}/{STARTER}")
        for include in file.includes:
            if self.changes(include.file):
                element = _element(text, file, include.element, ("include",))
                lead(text, element, include, f"{here}/{self._copy(include.file)}")
        return text

    def _edits(self, node: LaunchNode) -> tuple[str, ...]:
        return (*self._remaps(node), *(name for name in (node.name,) if name in self.starters))

    def _remaps(self, node: LaunchNode) -> tuple[str, ...]:
        return tuple(_remap(placed) for placed in self.wiring.get(node, ()) if placed.placeable)

    def _copy(self, file: LaunchFile) -> str:
        plain = _ODD.sub("_", os.path.basename(file.path))  # noqa: PTH119
        name = f"{len(self.texts) + 1:02}_{plain}"
        self.texts[name] = ""
        self.texts[name] = self._changed(file, "").changed()
        return name


def _dirname(path: str) -> str:
    """Return what `$(dirname)` means in a file; roslaunch does not follow links for it."""
    return os.path.abspath(os.path.dirname(path))  # noqa: PTH100, PTH120


def _remap(placed: PlacedRemap) -> str:
    return f"<remap from={quoteattr(placed.written)} to={quoteattr(placed.target)}/>"


def _element(text: LaunchText, file: LaunchFile, place: int, tags: Collection[str]) -> Span:
    if place >= len(text.elements) or text.elements[place].tag not in tags:
        raise InputError("has changed since it was read", path=file.path, help="start again")
    return text.elements[place]

"""The guarded launch's own files: the launch file, and the copies of its includes that change."""

import os.path
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from rtron.planning.instrument.instrumented import PlacedRemap
from rtron.planning.instrument.ros2.launch_file import LaunchFileText, Rule
from rtron.planning.instrument.ros2.wrapper import PrivateNames, wrapper_text
from rtron.planning.instrument.ros2.xml_file import xml_file
from rtron.planning.instrument.ros2.yaml_file import yaml_file
from rtron.planning.instrument.wiring import Wiring
from rtron.vocabulary import LaunchFile, LaunchNode

_ODD = re.compile(r"[^\w.-]")
_YAML = (".yaml", ".yml")


@dataclass(slots=True)
class Copies:
    """Makes changed copies; `texts` maps each copy's name to its text.

    Every inclusion has its own copy. A Python launch file is wrapped, and gets the whole `table`.
    `lost` says of nodes why their rules cannot be placed.
    """

    wiring: Wiring
    table: PrivateNames
    texts: dict[str, str] = field(default_factory=dict)
    lost: dict[LaunchNode, str] = field(default_factory=dict)

    def root(self, file: LaunchFile, folder: str, script: str, name: str) -> str:
        """Return the launch file's text with the guard; the copies lie beside it in `folder`."""
        if file.path.endswith(".py"):
            return wrapper_text(file.path, self.table, f"{folder}/{script}")
        text = self._changed(file, f"/{folder}")
        text.start(f"$(dirname)/{folder}/{script}", name)
        return text.changed()

    def _changed(self, file: LaunchFile, here: str) -> LaunchFileText:
        """Return a file with its remaps; `here` leads from its copy's folder to the others."""
        text = _text(file.path)
        for node in file.nodes:
            self._remap(text, node)
        for include in file.includes:
            if self._changes(include.file):
                text.lead(include.element, f"$(dirname){here}/{self._copy(include.file)}")
        return text

    def _remap(self, text: LaunchFileText, node: LaunchNode) -> None:
        rules = _rules(self.wiring.get(node, ()))
        if not rules:
            return
        own = text.own_rules(node.element)
        before = {remap.declared for remap in node.remaps[: len(node.remaps) - own]}
        placed = {remap.written for remap in node.remaps if remap.declared in before}
        if not any(source.rpartition(":")[2] in placed | {source} & placed for source, _ in rules):
            text.remap(node.element, rules)
        elif text.loads(node.element):
            self.lost[node] = "a set_remap counts before what a component can be given"
        else:
            text.remap_early(node.element, rules)

    def _changes(self, file: LaunchFile) -> bool:
        here = any(self.wiring.get(node) for node in file.nodes)
        below = any(self._changes(include.file) for include in file.includes)
        return here or below or file.path.endswith(".py")

    def _copy(self, file: LaunchFile) -> str:
        plain = _ODD.sub("_", os.path.basename(file.path))  # noqa: PTH119
        name = f"{len(self.texts) + 1:02}_{plain}"
        self.texts[name] = ""
        if file.path.endswith(".py"):
            self.texts[name] = wrapper_text(file.path, self.table)
        else:
            self.texts[name] = self._changed(file, "").changed()
        return name


def _text(path: str) -> LaunchFileText:
    folder = os.path.dirname(path)  # noqa: PTH120 - as launch spells it
    return yaml_file(path, folder) if path.endswith(_YAML) else xml_file(path, folder)


def _rules(placed: Sequence[PlacedRemap]) -> list[Rule]:
    return [(remap.written, remap.target) for remap in placed if remap.placeable]

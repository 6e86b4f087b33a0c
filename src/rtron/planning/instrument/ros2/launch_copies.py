"""The guarded launch's own files: the launch file, and the copies of its includes that change."""

import os.path
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.remaps import Wiring
from rtron.planning.instrument.ros2.arguments import CHECK, arguments_text
from rtron.planning.instrument.ros2.launch_file import LaunchFileText, Rule, Start
from rtron.planning.instrument.ros2.wrapper import PrivateNames, wrapper_text
from rtron.planning.instrument.ros2.xml_file import xml_file
from rtron.planning.instrument.ros2.yaml_file import yaml_file
from rtron.vocabulary import LaunchChoice, LaunchFile, LaunchNode

_FOLDER = "rtron_folder"
_ODD = re.compile(r"[^\w.-]")
_SPECIAL = re.compile(r"[\\$]")
_YAML = (".yaml", ".yml")


@dataclass(slots=True)
class Copies:
    """Makes changed copies; `texts` maps each copy's name to its text.

    Every inclusion has its own copy. A Python launch file is wrapped, and gets the whole `table`;
    `missing` are the nodes in it that no XML or YAML starts. `choices` are what the launch was
    read for. `lost` says of nodes why their rules cannot be placed.
    """

    folder: Path
    wiring: Wiring
    table: PrivateNames
    missing: Collection[str]
    choices: tuple[LaunchChoice, ...]
    texts: dict[str, str] = field(default_factory=dict)
    lost: dict[LaunchNode, str] = field(default_factory=dict)

    def root(self, file: LaunchFile, script: str, name: str) -> str:
        """Return the launch file's text with the guard, whose files lie beside it in `folder`."""
        if file.path.endswith(".py"):
            return wrapper_text(file.path, self.table, f"{self.folder.name}/{script}")
        text = self._changed(file)
        here = Start(folder=f"$(dirname)/{self.folder.name}", variable=_FOLDER)
        text.start(here, script=script, name=name, check=CHECK)
        self.texts[CHECK] = arguments_text(self.choices)
        return text.changed()

    def _changed(self, file: LaunchFile) -> LaunchFileText:
        """Return a file with its remaps, and its includes led to their copies.

        What `$(dirname)` means behind an include depends on launch's version, so that the folder
        is a configuration; where the app has cleared those, it is the folder's place as it was.
        """
        text = _text(file.path)
        for node in file.nodes:
            self._remap(text, node)
        for include in file.includes:
            if self._changes(include.file):
                copy = self._copy(include.file)
                text.lead(include.element, f"$(var {_FOLDER} {self.folder})/{copy}")
        return text

    def _remap(self, text: LaunchFileText, node: LaunchNode) -> None:
        rules = _rules(self.wiring.get(node, ()))
        if not rules:
            return
        if not _others_count(node, rules):
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
            self.texts[name] = wrapper_text(file.path, self.table, expected=self.missing)
        else:
            self.texts[name] = self._changed(file).changed()
        return name


def _text(path: str) -> LaunchFileText:
    folder = os.path.dirname(path)  # noqa: PTH120 - as launch spells it
    return yaml_file(path, folder) if path.endswith(_YAML) else xml_file(path, folder)


def _rules(placed: Sequence[PlacedRemap]) -> list[Rule]:
    return [
        (_literal(remap.written), _literal(remap.target)) for remap in placed if remap.placeable
    ]


def _others_count(node: LaunchNode, rules: Sequence[Rule]) -> bool:
    """Tell whether a rule that is not the element's own would count before one placed there."""
    shared = node.remaps[: node.shared]
    names = {remap.declared for remap in shared}
    written = {remap.written for remap in node.remaps if remap.declared in names}
    return any(source in written or source.rpartition(":")[2] in written for source, _ in rules)


def _literal(text: str) -> str:
    """Return a text in which launch finds no substitution."""
    return _SPECIAL.sub(r"\\\g<0>", text)

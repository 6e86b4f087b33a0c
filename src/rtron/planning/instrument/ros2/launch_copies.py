"""The guarded launch's own files: the launch file, and the copies of its includes that change."""

import os.path
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from pprint import pformat
from xml.sax.saxutils import quoteattr, unescape

from rtron.errors import InputError
from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.planning.instrument.common.xml_text import (
    PLAIN_TEXT,
    ElementSpan,
    LaunchText,
    find_elements,
    read_utf8,
)
from rtron.planning.instrument.ros2.enclaves import ENCLAVE_SCRIPT, Enclaves
from rtron.planning.instrument.ros2.launch_file import (
    PREFIX,
    GuardedFolder,
    GuardStart,
    LaunchFileText,
    RemapPair,
    prepend_remaps,
)
from rtron.planning.instrument.ros2.wrapper import PrivateNames, WrappedStart, wrapper_text
from rtron.planning.instrument.ros2.yaml_file import yaml_file
from rtron.vocabulary import LaunchFile, LaunchInput, LaunchNode

CHECK_FILE = "arguments.launch.py"
"""The file's name, beside the copies; it comes first in the launch."""

_TEMPLATE = "arguments.py.in"
_PLACEHOLDER = re.compile(r"__(ARGUMENTS|ENVIRONMENT)__")


def arguments_text(choices: tuple[LaunchInput, ...]) -> str:
    """Return the launch file that refuses all but the values for which a launch was read."""
    template = files("rtron.planning.instrument.ros2").joinpath(_TEMPLATE).read_text()
    filled = {
        hole: {each.name: each.values for each in choices if each.environment is environment}
        for hole, environment in (("ARGUMENTS", False), ("ENVIRONMENT", True))
    }
    return _PLACEHOLDER.sub(
        lambda hole: pformat(filled[hole[1]], width=88, sort_dicts=False), template
    )


_FOLDER = "rtron_folder"
_UNSAFE = re.compile(r"[^\w.-]")
_SPECIAL = re.compile(r"[\\$]")
_YAML = (".yaml", ".yml")


@dataclass(slots=True)
class LaunchCopies:
    """Makes changed copies; `texts` maps each copy's name to its text.

    Every inclusion has its own copy. A Python launch file is wrapped, and gets the whole `table`;
    `missing` are the nodes in it that no XML or YAML starts. `inputs` are what the launch was
    read for. With `enclaves`, each process starts in its own. `cells` are scripts by the nodes that
    run in a cell. `unreachable` says of nodes why their rules cannot be placed.
    """

    folder: Path
    remaps: NodeRemaps
    table: PrivateNames
    missing: Collection[str]
    inputs: tuple[LaunchInput, ...]
    enclaves: Enclaves | None = None
    cells: Mapping[str, str] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    unreachable: dict[LaunchNode, str] = field(default_factory=dict)

    def root(self, file: LaunchFile, script: str, name: str) -> str:
        """Return the launch file's text with the guard, whose files lie beside it in `folder`."""
        environment = self.enclaves.environment() if self.enclaves else {}
        if file.path.endswith(".py"):
            prefix = f"{self.folder.name}/{ENCLAVE_SCRIPT}" if self.enclaves else ""
            cells = {node: f"{self.folder.name}/{each}" for node, each in self.cells.items()}
            start = WrappedStart(f"{self.folder.name}/{script}", prefix, environment, cells)
            return wrapper_text(file.path, self.table, start)
        text = self._changed(file)
        guarded_folder = GuardedFolder(folder=f"$(dirname)/{self.folder.name}", variable=_FOLDER)
        guard = GuardStart(
            script=script,
            name=name,
            check=CHECK_FILE,
            environment=environment,
            prefix=ENCLAVE_SCRIPT if self.enclaves else "",
        )
        text.add_guard(guarded_folder, guard)
        self.texts[CHECK_FILE] = arguments_text(self.inputs)
        return text.render()

    def _changed(self, file: LaunchFile) -> LaunchFileText:
        """Return a file with its remaps, and its includes led to their copies.

        What `$(dirname)` means behind an include depends on launch's version, so that the folder
        is a configuration; where the app has cleared those, it is the folder's place as it was.
        """
        text = _text(file.path)
        for node in file.nodes:
            self._remap(text, node)
            if starter := self._starter(node):
                self._start_through(text, node, starter)
        for include in file.includes:
            if self._changes(include.file):
                copy = self._copy(include.file)
                text.redirect_include(include.element_index, self._in_folder(copy))
        return text

    def _starter(self, node: LaunchNode) -> str:
        """Return the script that starts a node, "" if none does."""
        return ENCLAVE_SCRIPT if self.enclaves else self.cells.get(node.name, "")

    def _start_through(self, text: LaunchFileText, node: LaunchNode, script: str) -> None:
        if node.name in self.cells and text.is_component(node.element_index):
            help = "start it as a node of its own"
            raise InputError(f"{node.name} is a component: it cannot run in a cell", help=help)
        text.start_through(node.element_index, self._in_folder(script), node.type)

    def _in_folder(self, name: str) -> str:
        return f"$(var {_FOLDER} {self.folder})/{name}"

    def _remap(self, text: LaunchFileText, node: LaunchNode) -> None:
        rules = _rules(self.remaps.get(node, ()))
        if not rules:
            return
        if not _is_overridden(node, rules):
            text.add_remaps(node.element_index, rules)
        elif text.is_component(node.element_index):
            self.unreachable[node] = "a set_remap counts before what a component can be given"
        else:
            text.add_early_remaps(node.element_index, rules)

    def _changes(self, file: LaunchFile) -> bool:
        here = any(self._starter(node) or self.remaps.get(node) for node in file.nodes)
        below = any(self._changes(include.file) for include in file.includes)
        return here or below or file.path.endswith(".py")

    def _copy(self, file: LaunchFile) -> str:
        plain = _UNSAFE.sub("_", os.path.basename(file.path))  # noqa: PTH119
        name = f"{len(self.texts) + 1:02}_{plain}"
        self.texts[name] = ""
        if file.path.endswith(".py"):
            prefix = ENCLAVE_SCRIPT if self.enclaves else ""
            start = WrappedStart(prefix=prefix, cells=self.cells)
            self.texts[name] = wrapper_text(file.path, self.table, start, self.missing)
        else:
            self.texts[name] = self._changed(file).render()
        return name


def _text(path: str) -> LaunchFileText:
    folder = os.path.dirname(path)  # noqa: PTH120 - as launch spells it
    return yaml_file(path, folder) if path.endswith(_YAML) else xml_file(path, folder)


def _rules(placed: Sequence[PlacedRemap]) -> list[RemapPair]:
    return [
        (_escape(remap.written), _escape(remap.target)) for remap in placed if remap.is_placeable
    ]


def _is_overridden(node: LaunchNode, rules: Sequence[RemapPair]) -> bool:
    """Tell whether a rule that is not the element's own would count before one placed there."""
    shared = node.remaps[: node.inherited_remap_count]
    names = {remap.source for remap in shared}
    written = {remap.written_source for remap in node.remaps if remap.source in names}
    return any(source in written or source.rpartition(":")[2] in written for source, _ in rules)


def _escape(text: str) -> str:
    """Return a text in which launch finds no substitution."""
    return _SPECIAL.sub(r"\\\g<0>", text)


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

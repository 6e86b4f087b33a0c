"""What all files of one launch share: where packages lie, what was read, what stayed unresolved."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.commands import DescribeRobot
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.common.xml_document import LaunchDocument, parse_launch
from rtron.sources.launch.common.yaml_tree import YamlFile, parse_yaml
from rtron.sources.launch.ros1.parameter_server import LaunchParameters
from rtron.sources.launch.ros1.unresolved import UnresolvedNotes
from rtron.vocabulary import LaunchRemap

MAX_BYTES = 8 * 1024 * 1024
MAX_TOTAL_BYTES = 4 * MAX_BYTES


@dataclass(slots=True)
class LaunchFileCache:
    """Files of some launches: launch and YAML files are parsed once, however often named.

    With `roots`, only what lies in these folders is read, links followed: a stranger's launch file
    must not show what else is on this machine.
    """

    roots: tuple[Path, ...] | None = None
    _launches: dict[str, LaunchDocument] = field(default_factory=dict)
    _yamls: dict[str, YamlFile] = field(default_factory=dict)
    _bytes_read: int = 0

    def launch(self, path: str) -> LaunchDocument:
        """Return a parsed launch file; raise InputError."""
        if path not in self._launches:
            self._check_roots(path)
            self._launches[path] = parse_launch(path)
        return self._launches[path]

    def yaml(self, path: str) -> YamlFile:
        """Return a parsed YAML file; raise InputError."""
        if path not in self._yamls:
            self._yamls[path] = parse_yaml(self.text(path), path)
        return self._yamls[path]

    def text(self, path: str) -> str:
        """Return a text file's content with Python's line ends; raise InputError."""
        try:
            text = self.data(path).decode("utf-8")
        except UnicodeDecodeError:
            raise InputError("not UTF-8 text", path=path) from None
        return text.replace("\r\n", "\n").replace("\r", "\n")

    def data(self, path: str) -> bytes:
        """Return a plain file's content; raise InputError if it is none or all are too large."""
        file = Path(path)
        self._check_roots(path)
        if not path_exists(file) or not file.is_file():
            raise InputError("no such file", path=path, help="check the path")
        data = read_bounded(file, MAX_BYTES)
        self._bytes_read += len(data)
        if self._bytes_read > MAX_TOTAL_BYTES:
            mebibytes = MAX_TOTAL_BYTES // 2**20
            raise InputError(f"not read: the launch reads {mebibytes} MiB without it", path=path)
        return data

    def _check_roots(self, path: str) -> None:
        if self.roots is None:
            return
        real = Path(path).resolve()
        if not any(real.is_relative_to(root) for root in self.roots):
            help = "if it belongs to the app, give its folder too"
            raise InputError("lies outside of the folders that are read", path=path, help=help)


@dataclass(slots=True, kw_only=True)
class LoadState:
    """What is common to all files of one launch.

    `include_count` counts the includes so far, `element_count` those of the included files.
    """

    packages: PackageIndex
    environ: Mapping[str, str]
    describe: DescribeRobot | None = None
    documents: LaunchFileCache = field(default_factory=LaunchFileCache)
    parameters: LaunchParameters = field(default_factory=LaunchParameters)
    unresolved: UnresolvedNotes = field(default_factory=UnresolvedNotes)
    remaps_behind_all: list[LaunchRemap] = field(default_factory=list)
    declared_arguments: set[str] = field(default_factory=set)
    include_count: int = 0
    element_count: int = 0

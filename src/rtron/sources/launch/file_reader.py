"""Reads one launch file, element by element, and below it the files it includes."""

import os.path
from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.launch.document import Element, LaunchDocument, parse_launch
from rtron.sources.launch.include_tag import included_scope, read_argument
from rtron.sources.launch.node_tag import read_node, read_remap
from rtron.sources.launch.packages import PackageIndex
from rtron.sources.launch.scope import Scope
from rtron.sources.launch.substitution import Substitution
from rtron.sources.launch.tag import Tag
from rtron.sources.launch.unresolvable import UnresolvableError
from rtron.sources.launch.unresolved import Notes
from rtron.vocabulary import LaunchFile, LaunchInclude, LaunchNode

MAX_DEPTH = 64
MAX_FILES = 1000


@dataclass(slots=True, kw_only=True)
class Reading:
    """What is common to all files of one launch; `included` counts the includes so far."""

    packages: PackageIndex
    environ: Mapping[str, str]
    notes: Notes = field(default_factory=Notes)
    included: int = 0


@dataclass(slots=True, kw_only=True)
class FileReader:
    """Collects the nodes and includes of one file; `depth` counts the includes above it."""

    document: LaunchDocument
    reading: Reading
    depth: int = 0
    _nodes: list[LaunchNode] = field(default_factory=list)
    _includes: list[LaunchInclude] = field(default_factory=list)

    def read(self, scope: Scope) -> None:
        """Read the whole file; what was read before an error stays in the result."""
        self._read_below(self.document.launch, scope)

    def result(self) -> LaunchFile:
        """Return what was read."""
        return LaunchFile(
            path=self.document.path, nodes=tuple(self._nodes), includes=tuple(self._includes)
        )

    def _read_below(self, parent: Element, scope: Scope) -> None:
        path = self.document.path
        for element in parent.iterchildren("*"):
            tag = Tag(element=element, path=path, substitution=self._substitution(scope))
            with self.reading.notes.noting(tag):
                if tag.applies():
                    self._read_element(tag, scope)

    def _read_element(self, tag: Tag, scope: Scope) -> None:
        place = self.document.places[tag.element]
        if tag.name == "arg":
            read_argument(tag, scope)
        elif tag.name == "remap":
            read_remap(tag, scope)
        elif tag.name == "group":
            self._read_below(tag.element, scope.inner(tag.optional("ns")))
        elif tag.name == "include":
            self._include(tag, place, included_scope(tag, scope))
        elif tag.name in {"node", "test"}:
            self._nodes.append(read_node(tag, scope, place, self.reading.notes))

    def _include(self, tag: Tag, place: int, scope: Scope) -> None:
        spelled, notes = tag.required("file"), self.reading.notes
        passed = set() if scope.overrides else set(scope.arguments)
        with notes.noting_include(tag):
            reader = self._opened(spelled)
            with notes.noting_include(tag):
                reader.read(scope)
                _check_use(passed - scope.declared)
            file = reader.result()
            self._includes.append(LaunchInclude(element=place, spelled=spelled, file=file))

    def _opened(self, spelled: str) -> "FileReader":
        """Return a reader of an included file; roslaunch takes it from the current directory."""
        if self.depth == MAX_DEPTH or self.reading.included == MAX_FILES:
            raise UnresolvableError(f"more than {MAX_DEPTH} includes deep, or {MAX_FILES} in all")
        self.reading.included += 1
        document = parse_launch(os.path.join(os.getcwd(), spelled))  # noqa: PTH109, PTH118 - keep `..`
        return FileReader(document=document, reading=self.reading, depth=self.depth + 1)

    def _substitution(self, scope: Scope) -> Substitution:
        return Substitution(
            packages=self.reading.packages,
            environ=self.reading.environ,
            folder=self.document.folder,
            arguments=scope.arguments,
        )


def _check_use(unused: set[str]) -> None:
    if unused:
        raise InputError(f"does not declare {', '.join(sorted(unused))}; roslaunch refuses that")

"""Reads one launch file, element by element, and below it the files it includes."""

import os.path
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.xml_document import Element, LaunchDocument
from rtron.sources.launch.ros1.environment_tags import check_machine, read_env
from rtron.sources.launch.ros1.include_tag import included_scope, read_argument
from rtron.sources.launch.ros1.load_state import Reading
from rtron.sources.launch.ros1.loader_context import Doubt, Scope
from rtron.sources.launch.ros1.node_tag import read_node, read_remap
from rtron.sources.launch.ros1.param_tag import read_param
from rtron.sources.launch.ros1.rosparam_tag import read_rosparam
from rtron.sources.launch.ros1.substitution_args import Substitution
from rtron.sources.launch.ros1.tag import Tag
from rtron.vocabulary import LaunchFile, LaunchInclude, LaunchNode

MAX_DEPTH = 64
MAX_FILES = 1000
MAX_ELEMENTS = 200_000


@dataclass(slots=True, kw_only=True)
class FileReader:
    """Collects the nodes and includes of one file; `above` are the files that include it."""

    document: LaunchDocument
    reading: Reading
    above: tuple[str, ...] = ()
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
                counted = self.reading.notes.counted(tag, scope)
                if counted is not None:
                    self._read_element(tag, counted)

    def _read_element(self, tag: Tag, scope: Scope) -> None:
        place = self.document.places[tag.element]
        if tag.name == "arg":
            read_argument(tag, scope)
        elif tag.name == "group":
            self._group(tag, scope.inner(tag.optional("ns")))
        elif tag.name == "include":
            self._include(tag, place, included_scope(tag, scope, self.reading.notes))
        elif tag.name in {"node", "test"}:
            self._nodes.append(read_node(tag, scope, place, self.reading))
        elif tag.name == "param":
            read_param(tag, scope, self.reading)
        elif tag.name == "rosparam":
            read_rosparam(tag, scope, self.reading)
        elif scope.doubt is not Doubt.OWN:
            self._read_setting(tag, scope)

    def _read_setting(self, tag: Tag, scope: Scope) -> None:
        """Read an element that is left out where its own condition is not known."""
        if tag.name == "remap":
            read_remap(tag, scope)
        elif tag.name == "env":
            read_env(tag, scope, self.reading.notes)
        elif tag.name == "machine":
            with self.reading.notes.noting_include(tag):
                check_machine(tag)

    def _group(self, tag: Tag, scope: Scope) -> None:
        self._clear(tag, scope)
        self._read_below(tag.element, scope)

    def _clear(self, tag: Tag, scope: Scope) -> None:
        if tag.clears():
            if tag.element.get("ns") is None:
                tag.fault("has 'clear_params' and no 'ns'")
            self.reading.parameters.clear(scope.namespace, scope.doubt)

    def _include(self, tag: Tag, place: int, scope: Scope) -> None:
        spelled, notes = tag.required("file"), self.reading.notes
        self._clear(tag, scope)
        passed = set() if scope.overrides else set(scope.arguments)
        with notes.noting_include(tag):
            reader = self._opened(spelled, scope)
            with notes.noting_include(tag):
                reader.read(scope)
                _check_use(passed - scope.declared)
            file = reader.result()
            self._includes.append(LaunchInclude(element=place, spelled=spelled, file=file))

    def _opened(self, spelled: str, scope: Scope) -> "FileReader":
        """Return a reader of an included file; roslaunch takes it from the current directory."""
        path, above = os.path.join(os.getcwd(), spelled), (*self.above, self.document.path)  # noqa: PTH109, PTH118 - keep `..`
        if len(above) > MAX_DEPTH or self.reading.included == MAX_FILES:
            raise UnresolvableError(f"more than {MAX_DEPTH} includes deep, or {MAX_FILES} in all")
        if scope.doubt and path in above:
            raise UnresolvableError("includes itself, until a condition that is not known ends it")
        self.reading.included += 1
        document = self.reading.documents.launch(path)
        self.reading.elements += len(document.places)
        if self.reading.elements > MAX_ELEMENTS:
            raise UnresolvableError(f"more than {MAX_ELEMENTS} elements in all included files")
        return FileReader(document=document, reading=self.reading, above=above)

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

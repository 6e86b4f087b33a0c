"""The launch files of an app, read into one parameter server: the given and the started ones."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.ros1.reader import read_launches
from rtron.sources.static.common.app_node import AppNode, launched_node
from rtron.sources.static.common.unresolved import Notes
from rtron.sources.static.ros1.runtime_launches import StartedFile
from rtron.sources.xacro import RobotDescriptions
from rtron.vocabulary import LaunchTree, Parameters

Launch: TypeAlias = tuple[Path, Mapping[str, str]]


@dataclass(slots=True, kw_only=True)
class StartedLaunches:
    """The trees, the given launch files' first; `files` are those that nodes start."""

    given: tuple[Launch, ...]
    packages: PackageIndex
    folders: tuple[Path, ...]
    descriptions: RobotDescriptions
    trees: tuple[LaunchTree, ...] = ()
    files: list[StartedFile] = field(default_factory=list)
    notes: Notes = field(default_factory=Notes)

    @property
    def parameters(self) -> Parameters:
        """The parameter server after all that was read so far."""
        return self.trees[0].parameters if self.trees else Parameters()

    def read(self) -> list[AppNode]:
        """Return the nodes of the given launch files; raise InputError if one is wrong."""
        self.trees = self._read(())
        return [node for tree in self.trees for node in self._nodes(tree, "")]

    def read_more(self, files: Iterable[StartedFile]) -> list[AppNode]:
        """Return the nodes of launch files that nodes start; one that is wrong is noted."""
        wanted = list(files)
        with suppress(InputError):
            return self._added(wanted)
        return [node for file in wanted for node in self._tried(file)]

    def _tried(self, file: StartedFile) -> list[AppNode]:
        try:
            return self._added([file])
        except InputError as error:
            what = f"launch {file.path.name} that {file.by} starts"
            self.notes.add(what, str(error), file.evidence)
            return []

    def _added(self, files: list[StartedFile]) -> list[AppNode]:
        if not files:
            return []
        trees = self._read((*self.files, *files))
        new = zip(trees[len(self.trees) :], files, strict=True)
        self.trees = trees
        self.files.extend(files)
        return [node for tree, file in new for node in self._nodes(tree, file.by)]

    def _read(self, files: Iterable[StartedFile]) -> tuple[LaunchTree, ...]:
        return read_launches(
            [*self.given, *((file.path, dict(file.args)) for file in files)],
            self.packages,
            self.descriptions.environ,
            describe=self.descriptions.describe,
            roots=self._roots(),
        )

    def _roots(self) -> Iterator[Path]:
        """Yield the folders that launch files and their data may lie in."""
        yield from self.folders
        yield from self.packages.values()
        yield from (path.absolute().parent for path, _ in self.given)

    def _nodes(self, tree: LaunchTree, started_by: str) -> list[AppNode]:
        environ = self.descriptions.environ
        found = (
            launched_node(node, file.path, tree.parameters, environ)
            for file in tree.root.walk()
            for node in file.nodes
        )
        return [replace(node, started_by=started_by) for node in found]

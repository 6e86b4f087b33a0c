"""The launch files of an app, read into one parameter server: the given and the started ones."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.ros1.reader import read_launches
from rtron.sources.static.common.app_node import AppNode, node_of_launch
from rtron.sources.static.common.launch_paths import LaunchRequest
from rtron.sources.static.common.unresolved import UnresolvedList
from rtron.sources.static.ros1.runtime_launches import RuntimeLaunch
from rtron.sources.xacro import RobotDescriptions
from rtron.vocabulary import LaunchTree, ParameterTree
from rtron.vocabulary.enums import HiddenPart


@dataclass(slots=True, kw_only=True)
class LaunchTrees:
    """The trees, the given launch files' first; `runtime_launches` are those that nodes start."""

    requested: tuple[LaunchRequest, ...]
    packages: PackageIndex
    folders: tuple[Path, ...]
    descriptions: RobotDescriptions
    trees: tuple[LaunchTree, ...] = ()
    runtime_launches: list[RuntimeLaunch] = field(default_factory=list)
    unresolved: UnresolvedList = field(default_factory=UnresolvedList)

    @property
    def parameters(self) -> ParameterTree:
        """The parameter server after all that was read so far."""
        return self.trees[0].parameters if self.trees else ParameterTree()

    def read_requested(self) -> list[AppNode]:
        """Return the nodes of the given launch files; raise InputError if one is wrong."""
        self.trees = self._read(())
        return [node for tree in self.trees for node in self._nodes(tree, "")]

    def read_runtime_launches(self, files: Iterable[RuntimeLaunch]) -> list[AppNode]:
        """Return the nodes of launch files that nodes start; one that is wrong is noted."""
        launches = list(files)
        with suppress(InputError):
            return self._add_launches(launches)
        return [node for file in launches for node in self._read_one(file)]

    def _read_one(self, file: RuntimeLaunch) -> list[AppNode]:
        try:
            return self._add_launches([file])
        except InputError as error:
            what = f"launch {file.path.name} that {file.started_by} starts"
            self.unresolved.add(what, str(error), file.evidence, HiddenPart.NODES)
            return []

    def _add_launches(self, files: list[RuntimeLaunch]) -> list[AppNode]:
        if not files:
            return []
        trees = self._read((*self.runtime_launches, *files))
        added = zip(trees[len(self.trees) :], files, strict=True)
        self.trees = trees
        self.runtime_launches.extend(files)
        return [node for tree, file in added for node in self._nodes(tree, file.started_by)]

    def _read(self, files: Iterable[RuntimeLaunch]) -> tuple[LaunchTree, ...]:
        return read_launches(
            [*self.requested, *((file.path, dict(file.args)) for file in files)],
            self.packages,
            self.descriptions.environ,
            describe=self.descriptions.describe,
            roots=self._roots(),
        )

    def _roots(self) -> Iterator[Path]:
        """Yield the folders that launch files and their data may lie in."""
        yield from self.folders
        yield from self.packages.values()
        yield from (path.absolute().parent for path, _ in self.requested)

    def _nodes(self, tree: LaunchTree, started_by: str) -> list[AppNode]:
        environ = self.descriptions.environ
        nodes = (
            node_of_launch(node, file.path, tree.parameters, environ)
            for file in tree.root.walk()
            for node in file.nodes
        )
        return [replace(node, started_by=started_by) for node in nodes]

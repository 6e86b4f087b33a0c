"""The YAML files of one launch: those that it reads, and those that it makes on the way."""

from collections.abc import Callable
from dataclasses import dataclass, field

from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree
from rtron.sources.launch.ros2.limits import Bounds
from rtron.sources.launch.ros2.parameters.file import entries_of, read_tree
from rtron.sources.launch.ros2.parameters.merge import Entries


@dataclass(slots=True)
class YamlFiles:
    """Reads each file once; `installed` finds the source of one that a build would install."""

    bounds: Bounds = field(default_factory=Bounds)
    installed: Callable[[str], str] = str
    _trees: dict[str, YamlTree] = field(default_factory=dict)
    _entries: dict[str, Entries] = field(default_factory=dict)
    _made: int = 0

    @property
    def made(self) -> dict[str, YamlTree]:
        """The files that the launch makes, by what they are called."""
        return {path: tree for path, tree in self._trees.items() if "#" in path}

    def read(self, path: str) -> YamlTree:
        """Return a file; raise InputError for one that is not there, or no YAML."""
        if path not in self._trees:
            self._keep(path, read_tree(self.installed(path)))
        return self._trees[path]

    def entries(self, path: str) -> Entries:
        """Return what a parameter file says for which nodes; raise InputError as `read`."""
        if path not in self._entries:
            self._entries[path] = entries_of(self.read(path), self.installed(path))
        return self._entries[path]

    def make(self, source: str, tree: YamlTree) -> str:
        """Keep a file that exists only while the launch runs; return what it is called."""
        self._made += 1
        path = f"{source.partition('#')[0]}#{self._made}"
        self._keep(path, tree)
        return path

    def _keep(self, path: str, tree: YamlTree) -> None:
        self.bounds.value(path, _leaves(tree))
        self._trees[path] = tree


def _leaves(tree: YamlTree) -> int:
    return 1 if isinstance(tree, YamlLeaf) else 1 + sum(map(_leaves, tree.values()))

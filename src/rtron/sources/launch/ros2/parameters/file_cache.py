"""The YAML files of one launch: those that it reads, and those that it makes on the way."""

from collections.abc import Callable
from dataclasses import dataclass, field

from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree
from rtron.sources.launch.ros2.limits import LaunchLimits
from rtron.sources.launch.ros2.parameters.file import parameter_entries, read_yaml_tree
from rtron.sources.launch.ros2.parameters.merge import Entries


@dataclass(slots=True)
class YamlFileCache:
    """Reads each file once; `locate_source` finds the source of one that a build would install."""

    limits: LaunchLimits = field(default_factory=LaunchLimits)
    locate_source: Callable[[str], str] = str
    _trees: dict[str, YamlTree] = field(default_factory=dict)
    _entries: dict[str, Entries] = field(default_factory=dict)
    _generated_count: int = 0

    @property
    def generated_files(self) -> dict[str, YamlTree]:
        """The files that the launch makes, by what they are called."""
        return {path: tree for path, tree in self._trees.items() if "#" in path}

    def read(self, path: str) -> YamlTree:
        """Return a file; raise InputError for one that is not there, or no YAML."""
        if path not in self._trees:
            self._store(path, read_yaml_tree(self.locate_source(path)))
        return self._trees[path]

    def entries(self, path: str) -> Entries:
        """Return what a parameter file says for which nodes; raise InputError as `read`."""
        if path not in self._entries:
            self._entries[path] = parameter_entries(self.read(path), self.locate_source(path))
        return self._entries[path]

    def add_generated(self, source: str, tree: YamlTree) -> str:
        """Keep a file that exists only while the launch runs; return what it is called."""
        self._generated_count += 1
        path = f"{source.partition('#')[0]}#{self._generated_count}"
        self._store(path, tree)
        return path

    def _store(self, path: str, tree: YamlTree) -> None:
        self.limits.count_values(path, _count_values(tree))
        self._trees[path] = tree


def _count_values(tree: YamlTree) -> int:
    return 1 if isinstance(tree, YamlLeaf) else 1 + sum(map(_count_values, tree.values()))

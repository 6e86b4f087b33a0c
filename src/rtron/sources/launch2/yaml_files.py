"""The YAML files of one launch: those that it reads, and those that it makes on the way."""

from collections.abc import Callable
from dataclasses import dataclass, field

from rtron.sources.launch.yaml_text import YamlTree
from rtron.sources.launch2.parameter_file import read_tree


@dataclass(slots=True)
class YamlFiles:
    """Reads each file once; `installed` finds the source of one that a build would install."""

    installed: Callable[[str], str] = str
    _trees: dict[str, YamlTree] = field(default_factory=dict)
    _made: int = 0

    def read(self, path: str) -> YamlTree:
        """Return a file; raise InputError for one that is not there, or no YAML."""
        if path not in self._trees:
            self._trees[path] = read_tree(self.installed(path))
        return self._trees[path]

    def make(self, source: str, tree: YamlTree) -> str:
        """Keep a file that exists only while the launch runs; return what it is called."""
        self._made += 1
        path = f"{source.partition('#')[0]}#{self._made}"
        self._trees[path] = tree
        return path

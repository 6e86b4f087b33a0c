"""Parameter files of ROS 2: values below the names of nodes and `ros__parameters`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree, all_entries, parse_yaml
from rtron.sources.launch.ros2.limits import LaunchLimits
from rtron.sources.launch.ros2.parameters.merge import Entries
from rtron.sources.launch.ros2.substitutions.template import display_text, has_placeholder
from rtron.vocabulary import Evidence, ParameterValue, UnknownValue
from rtron.vocabulary.parameters import Parameter

MAX_BYTES = 4 * 2**20
_PARAMETERS_KEY = "ros__parameters"


def read_yaml_tree(path: str) -> YamlTree:
    """Return a YAML file; raise InputError for one that is not there, or no YAML."""
    return parse_yaml_tree(read_text_file(path), path)


def read_text_file(path: str) -> str:
    """Return a file's text; raise InputError for one that is not there."""
    if not path_exists(Path(path)) or not Path(path).is_file():
        raise InputError("is no file", path=display_text(path))
    return read_bounded(Path(path), MAX_BYTES).decode("utf-8", "replace")


def parse_yaml_tree(text: str, path: str) -> YamlTree:
    """Return a YAML text that stands, or would stand, in a file; an empty one is empty."""
    documents = parse_yaml(text, path).documents
    document = documents[0] if documents else None
    return {} if document is None else document


def parameter_entries(tree: YamlTree, path: str) -> Entries:
    """Return what a parameter file says for which nodes."""
    return tuple(_entries(tree, "", path))


def _entries(
    tree: YamlTree, namespace: str, path: str
) -> Iterator[tuple[str, dict[str, Parameter]]]:
    for key, inner in all_entries(tree) if isinstance(tree, dict) else ():
        if key == _PARAMETERS_KEY:
            yield namespace or "/", dict(flatten(inner, "", path))
        else:
            yield from _entries(inner, f"{namespace}/{key.strip('/')}", path)


def flatten(tree: YamlTree, prefix: str, path: str) -> Iterator[tuple[str, Parameter]]:
    """Yield values by their flat names, `a.b`."""
    if isinstance(tree, YamlLeaf):
        location = Evidence(file=path.partition("#")[0], line=tree.line)
        yield prefix, Parameter(value=tree.value, evidence=location)
        return
    for key, inner in all_entries(tree):
        yield from flatten(inner, f"{prefix}.{key}" if prefix else key, path)


def parse_value(text: str) -> ParameterValue:
    """Return what a text is by the rules of YAML, as launch_ros takes it; else the text itself."""
    if has_placeholder(text):
        return string_value(text)
    try:
        leaf = parse_yaml_tree(text, "")
    except InputError:
        return text
    plain = leaf.value if isinstance(leaf, YamlLeaf) else text
    return text if isinstance(plain, UnknownValue) else plain


def string_value(text: str) -> str | UnknownValue:
    """Return a text that stays one; what is not known of it stands in braces."""
    return UnknownValue(display_text(text)) if has_placeholder(text) else text


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

"""Parameter files of ROS 2: values below the names of nodes and `ros__parameters`."""

from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.bounded_file import read_bounded
from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree, parse_yaml
from rtron.sources.launch.ros2.parameters.merge import Entries
from rtron.sources.launch.ros2.substitutions.template import has_hole, shown
from rtron.vocabulary import Evidence, ParameterValue, UnknownValue
from rtron.vocabulary.parameters import Parameter

MAX_BYTES = 4 * 2**20
_KEY = "ros__parameters"


def read_tree(path: str) -> YamlTree:
    """Return a YAML file; raise InputError for one that is not there, or no YAML."""
    return tree_of(read_text(path), path)


def read_text(path: str) -> str:
    """Return a file's text; raise InputError for one that is not there."""
    if not is_there(Path(path)) or not Path(path).is_file():
        raise InputError("is no file", path=shown(path))
    return read_bounded(Path(path), MAX_BYTES).decode("utf-8", "replace")


def tree_of(text: str, path: str) -> YamlTree:
    """Return a YAML text that stands, or would stand, in a file; an empty one is empty."""
    documents = parse_yaml(text, path).documents
    found = documents[0] if documents else None
    return {} if found is None else found


def entries_of(tree: YamlTree, path: str) -> Entries:
    """Return what a parameter file says for which nodes."""
    return tuple(_entries(tree, "", path))


def _entries(tree: YamlTree, space: str, path: str) -> Iterator[tuple[str, dict[str, Parameter]]]:
    for key, inner in tree.items() if isinstance(tree, dict) else ():
        if key == _KEY:
            yield space or "/", dict(flat(inner, "", path))
        else:
            yield from _entries(inner, f"{space}/{key.strip('/')}", path)


def flat(tree: YamlTree, prefix: str, path: str) -> Iterator[tuple[str, Parameter]]:
    """Yield values by their flat names, `a.b`."""
    if isinstance(tree, YamlLeaf):
        place = Evidence(file=path.partition("#")[0], line=tree.line)
        yield prefix, Parameter(value=tree.value, evidence=place)
        return
    for key, inner in tree.items():
        yield from flat(inner, f"{prefix}.{key}" if prefix else key, path)


def yaml_value(text: str) -> ParameterValue:
    """Return what a text is by the rules of YAML, as launch_ros takes it; else the text itself."""
    if has_hole(text):
        return text_value(text)
    try:
        leaf = tree_of(text, "")
    except InputError:
        return text
    plain = leaf.value if isinstance(leaf, YamlLeaf) else text
    return text if isinstance(plain, UnknownValue) else plain


def text_value(text: str) -> str | UnknownValue:
    """Return a text that stays one; what is not known of it stands in braces."""
    return UnknownValue(shown(text)) if has_hole(text) else text

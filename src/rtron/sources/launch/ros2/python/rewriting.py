"""A parameter file with other values, keys and root, as Nav2's RewrittenYaml makes it.

Source: the docstring of nav2_common.launch.RewrittenYaml, and what it does when it runs.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree
from rtron.sources.launch.ros2.substitutions.template import has_hole, shown
from rtron.vocabulary import ParameterValue, UnknownValue

Texts = Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rewriting:
    """What is changed: parameters by their key or whole path, values, keys; `root` goes above."""

    parameters: Texts = field(default_factory=dict)
    values: Texts = field(default_factory=dict)
    keys: Texts = field(default_factory=dict)
    root: str = ""
    numbers: bool = False

    def apply(self, tree: YamlTree) -> YamlTree:
        """Return the tree as it is written for the launch."""
        found = self._parameters(tree, "")
        for path in self.parameters.keys() - set(_paths(tree, "")):
            if "ros__parameters" in path.split("."):
                found = _put(found, path.split("."), self._leaf(self.parameters[path], 0))
        found = self._values(self._keys(found))
        return {self.root: found} if self.root else found

    def _parameters(self, tree: YamlTree, path: str) -> YamlTree:
        if isinstance(tree, YamlLeaf):
            return tree
        found: dict[str, YamlTree] = {}
        for key, inner in tree.items():
            below = f"{path}.{key}" if path else key
            text = self.parameters.get(below, self.parameters.get(key))
            changed = None if text is None else self._leaf(text, _line(inner))
            found[key] = self._parameters(inner, below) if changed is None else changed
        return found

    def _leaf(self, text: str, line: int) -> YamlLeaf:
        return YamlLeaf(value=self._converted(text), line=line)

    def _values(self, tree: YamlTree) -> YamlTree:
        if isinstance(tree, YamlLeaf):
            return YamlLeaf(value=self._value(tree.value), line=tree.line)
        return {key: self._values(inner) for key, inner in tree.items()}

    def _value(self, value: ParameterValue) -> ParameterValue:
        if isinstance(value, list):
            return [self._value(item) for item in value]
        text = self.values.get(str(value))
        return value if text is None else self._converted(text)

    def _keys(self, tree: YamlTree) -> YamlTree:
        if isinstance(tree, YamlLeaf) or not self.keys:
            return tree
        return {self.keys.get(key, key): self._keys(inner) for key, inner in tree.items()}

    def _converted(self, text: str) -> ParameterValue:
        if has_hole(text):
            return UnknownValue(shown(text))
        if self.numbers:
            try:
                return float(text) if "." in text else int(text)
            except ValueError:
                pass
        return {"true": True, "false": False}.get(text.lower(), text)


def _line(tree: YamlTree) -> int:
    return tree.line if isinstance(tree, YamlLeaf) else 0


def _paths(tree: YamlTree, path: str) -> Iterator[str]:
    if isinstance(tree, YamlLeaf):
        yield path
        return
    for key, inner in tree.items():
        yield from _paths(inner, f"{path}.{key}" if path else key)


def _put(tree: YamlTree, path: list[str], leaf: YamlLeaf) -> YamlTree:
    first, *rest = path
    found = dict(tree) if isinstance(tree, dict) else {}
    found[first] = _put(found.get(first, {}), rest, leaf) if rest else leaf
    return found

"""A parameter file with other values, keys and root, as Nav2's RewrittenYaml makes it.

Source: the docstring of nav2_common.launch.RewrittenYaml, and what it does when it runs.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree
from rtron.sources.launch.ros2.substitutions.template import display_text, has_placeholder
from rtron.vocabulary import ParameterValue, UnknownValue

Texts = Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRewrite:
    """What is changed: parameters by their key or whole path, values, keys; `root_key` goes above."""

    parameters: Texts = field(default_factory=dict)
    values: Texts = field(default_factory=dict)
    keys: Texts = field(default_factory=dict)
    root_key: str = ""
    converts_numbers: bool = False

    def apply(self, tree: YamlTree) -> YamlTree:
        """Return the tree as it is written for the launch."""
        rewritten = self._parameters(tree, "")
        for path in self.parameters.keys() - set(_leaf_paths(tree, "")):
            if "ros__parameters" in path.split("."):
                rewritten = _with_leaf(
                    rewritten, path.split("."), self._leaf(self.parameters[path], 0)
                )
        rewritten = self._values(self._keys(rewritten))
        return {self.root_key: rewritten} if self.root_key else rewritten

    def _parameters(self, tree: YamlTree, path: str) -> YamlTree:
        if isinstance(tree, YamlLeaf):
            return tree
        rewritten: dict[str, YamlTree] = {}
        for key, inner in tree.items():
            below = f"{path}.{key}" if path else key
            text = self.parameters.get(below, self.parameters.get(key))
            changed = None if text is None else self._leaf(text, _line(inner))
            rewritten[key] = self._parameters(inner, below) if changed is None else changed
        return rewritten

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
        if has_placeholder(text):
            return UnknownValue(display_text(text))
        if self.converts_numbers:
            try:
                return float(text) if "." in text else int(text)
            except ValueError:
                pass
        return {"true": True, "false": False}.get(text.lower(), text)


def _line(tree: YamlTree) -> int:
    return tree.line if isinstance(tree, YamlLeaf) else 0


def _leaf_paths(tree: YamlTree, path: str) -> Iterator[str]:
    if isinstance(tree, YamlLeaf):
        yield path
        return
    for key, inner in tree.items():
        yield from _leaf_paths(inner, f"{path}.{key}" if path else key)


def _with_leaf(tree: YamlTree, path: list[str], leaf: YamlLeaf) -> YamlTree:
    first, *rest = path
    rewritten = dict(tree) if isinstance(tree, dict) else {}
    rewritten[first] = _with_leaf(rewritten.get(first, {}), rest, leaf) if rest else leaf
    return rewritten

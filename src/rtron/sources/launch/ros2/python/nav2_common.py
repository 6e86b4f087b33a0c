"""The substitutions of nav2_common that read parameter files, and make others of them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.launch.common.yaml_tree import YamlDocument, YamlLeaf, YamlTree
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.parameters.file import parse_yaml_tree, read_text_file
from rtron.sources.launch.ros2.python.substitutions import (
    Fields,
    PerformSubstitution,
    SubstitutionTranslator,
    plain_text,
)
from rtron.sources.launch.ros2.substitutions.template import (
    display_text,
    has_placeholder,
    placeholder,
)
from rtron.vocabulary import ParameterValue, UnknownValue

Texts = Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRewrite:
    """What changes: parameters by key or whole path, values, keys; `root_key` goes above."""

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


_CONDITION = "condition"


def _rewritten_yaml(translator: SubstitutionTranslator, fields: Fields) -> PerformSubstitution:
    def run(view: ContextView) -> str:
        path, tree = _tree(translator, fields, view)
        if tree is None:
            return placeholder(f"rewritten {display_text(path)}")
        rewriting = ParameterRewrite(
            parameters=_evaluated_texts(translator, fields.get("param_rewrites"), view),
            values=_evaluated_texts(translator, fields.get("value_rewrites"), view),
            keys=_evaluated_texts(translator, fields.get("key_rewrites"), view),
            root_key=display_text(view.perform(translator.template(fields.get("root_key")))),
            converts_numbers=av.truth(fields.get("convert_types", av.NONE)) is True,
        )
        return view.files.add_generated(path, rewriting.apply(tree))

    return run


def _replaced_string(translator: SubstitutionTranslator, fields: Fields) -> PerformSubstitution:
    def run(view: ContextView) -> str:
        path = view.perform(translator.template(fields.get("source_file")))
        condition = fields.get(_CONDITION, av.NONE)
        if condition != av.NONE and not _condition_holds(translator, condition, view):
            return path
        replacements = _evaluated_texts(translator, fields.get("replacements"), view)
        try:
            if path in view.files.generated_files:
                tree = _replaced_tree(view.files.read(path), replacements)
            else:
                tree = parse_yaml_tree(_replaced_text(read_text_file(path), replacements), path)
            return view.files.add_generated(path, tree)
        except InputError as error:
            view.note(f"{display_text(path)}: {error}")
            return placeholder(f"replaced {display_text(path)}")

    return run


def _replaced_text(text: str, replacements: Texts) -> str:
    for pattern, replacement in replacements.items():
        text = text.replace(pattern, replacement)
    return text


def _replaced_tree(tree: YamlTree, replacements: Texts) -> YamlTree:
    """Return a tree that the launch has made with the texts in it replaced."""
    if not isinstance(tree, YamlLeaf):
        return {
            _replaced_text(key, replacements): _replaced_tree(inner, replacements)
            for key, inner in tree.items()
        }
    return YamlLeaf(value=_replaced_value(tree.value, replacements), line=tree.line)


def _replaced_value(value: ParameterValue, replacements: Texts) -> ParameterValue:
    if isinstance(value, list):
        return [_replaced_value(item, replacements) for item in value]
    return _replaced_text(value, replacements) if isinstance(value, str) else value


def _condition_holds(
    translator: SubstitutionTranslator, condition: av.Value, view: ContextView
) -> bool:
    text = view.perform(translator.template(condition))
    return has_placeholder(text) or text.strip().lower() in {"true", "1"}


def _has_node_parameters(translator: SubstitutionTranslator, fields: Fields) -> PerformSubstitution:
    def run(view: ContextView) -> str:
        _, tree = _tree(translator, fields, view)
        name = plain_text(fields.get("node_name"))
        if tree is None:
            return placeholder(f"parameters of {name}")
        return str(isinstance(tree, dict) and name in tree)

    return run


def _tree(
    translator: SubstitutionTranslator, fields: Fields, view: ContextView
) -> tuple[str, YamlDocument]:
    path = view.perform(translator.template(fields.get("source_file")))
    try:
        return path, None if has_placeholder(path) else view.files.read(path)
    except InputError as error:
        view.note(str(error))
        return path, None


def _evaluated_texts(
    translator: SubstitutionTranslator, value: av.Value | None, view: ContextView
) -> dict[str, str]:
    entries = value.entries if isinstance(value, av.MapValue) else {}
    return {str(key): view.perform(translator.template(inner)) for key, inner in entries.items()}


FILE_SUBSTITUTIONS: Mapping[
    str, Callable[[SubstitutionTranslator, Fields], PerformSubstitution]
] = {
    "HasNodeParams": _has_node_parameters,
    "ReplaceString": _replaced_string,
    "RewrittenYaml": _rewritten_yaml,
}
"""The substitutions by their classes' names."""

"""The substitutions of nav2_common that read parameter files, and make others of them."""

from collections.abc import Callable, Mapping

from rtron.errors import InputError
from rtron.sources.code.interpreter.abstract_values.value_types import NONE, MapValue, Value, truth
from rtron.sources.launch.common.yaml_tree import YamlDocument
from rtron.sources.launch.ros2.context_view import View
from rtron.sources.launch.ros2.parameters.file import read_text, tree_of
from rtron.sources.launch.ros2.python.rewriting import Rewriting
from rtron.sources.launch.ros2.python.substitutions import Fields, Run, Texts, plain_text
from rtron.sources.launch.ros2.substitutions.template import has_hole, hole, shown

_CONDITION = "condition"


def _rewritten(texts: Texts, fields: Fields) -> Run:
    def run(view: View) -> str:
        path, tree = _tree(texts, fields, view)
        if tree is None:
            return hole(f"rewritten {shown(path)}")
        rewriting = Rewriting(
            parameters=_texts(texts, fields.get("param_rewrites"), view),
            values=_texts(texts, fields.get("value_rewrites"), view),
            keys=_texts(texts, fields.get("key_rewrites"), view),
            root=shown(view.perform(texts.pieces(fields.get("root_key")))),
            numbers=truth(fields.get("convert_types", NONE)) is True,
        )
        return view.files.make(path, rewriting.apply(tree))

    return run


def _replaced(texts: Texts, fields: Fields) -> Run:
    def run(view: View) -> str:
        path = view.perform(texts.pieces(fields.get("source_file")))
        condition = fields.get(_CONDITION, NONE)
        if condition != NONE and not _holds(texts, condition, view):
            return path
        replacements = _texts(texts, fields.get("replacements"), view)
        try:
            text = read_text(path)
            for old, new in replacements.items():
                text = text.replace(old, new)
            return view.files.make(path, tree_of(text, path))
        except InputError as error:
            view.note(f"{shown(path)}: {error}")
            return hole(f"replaced {shown(path)}")

    return run


def _holds(texts: Texts, condition: Value, view: View) -> bool:
    text = view.perform(texts.pieces(condition))
    return has_hole(text) or text.strip().lower() in {"true", "1"}


def _has_parameters(texts: Texts, fields: Fields) -> Run:
    def run(view: View) -> str:
        _, tree = _tree(texts, fields, view)
        name = plain_text(fields.get("node_name"))
        if tree is None:
            return hole(f"parameters of {name}")
        return str(isinstance(tree, dict) and name in tree)

    return run


def _tree(texts: Texts, fields: Fields, view: View) -> tuple[str, YamlDocument]:
    path = view.perform(texts.pieces(fields.get("source_file")))
    try:
        return path, None if has_hole(path) else view.files.read(path)
    except InputError as error:
        view.note(str(error))
        return path, None


def _texts(texts: Texts, value: Value | None, view: View) -> dict[str, str]:
    entries = value.entries if isinstance(value, MapValue) else {}
    return {str(key): view.perform(texts.pieces(inner)) for key, inner in entries.items()}


FILES: Mapping[str, Callable[[Texts, Fields], Run]] = {
    "HasNodeParams": _has_parameters,
    "ReplaceString": _replaced,
    "RewrittenYaml": _rewritten,
}
"""The substitutions by their classes' names."""

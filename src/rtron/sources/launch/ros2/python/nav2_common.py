"""The substitutions of nav2_common that read parameter files, and make others of them."""

from collections.abc import Callable, Mapping

from rtron.errors import InputError
from rtron.sources.code.interpreter.abstract_values.value_types import NONE, MapValue, Value, truth
from rtron.sources.launch.common.yaml_tree import YamlDocument
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.parameters.file import parse_yaml_tree, read_text_file
from rtron.sources.launch.ros2.python.rewriting import ParameterRewrite
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
            converts_numbers=truth(fields.get("convert_types", NONE)) is True,
        )
        return view.files.add_generated(path, rewriting.apply(tree))

    return run


def _replaced_string(translator: SubstitutionTranslator, fields: Fields) -> PerformSubstitution:
    def run(view: ContextView) -> str:
        path = view.perform(translator.template(fields.get("source_file")))
        condition = fields.get(_CONDITION, NONE)
        if condition != NONE and not _condition_holds(translator, condition, view):
            return path
        replacements = _evaluated_texts(translator, fields.get("replacements"), view)
        try:
            text = read_text_file(path)
            for pattern, replacement in replacements.items():
                text = text.replace(pattern, replacement)
            return view.files.add_generated(path, parse_yaml_tree(text, path))
        except InputError as error:
            view.note(f"{display_text(path)}: {error}")
            return placeholder(f"replaced {display_text(path)}")

    return run


def _condition_holds(
    translator: SubstitutionTranslator, condition: Value, view: ContextView
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
    translator: SubstitutionTranslator, value: Value | None, view: ContextView
) -> dict[str, str]:
    entries = value.entries if isinstance(value, MapValue) else {}
    return {str(key): view.perform(translator.template(inner)) for key, inner in entries.items()}


FILE_SUBSTITUTIONS: Mapping[
    str, Callable[[SubstitutionTranslator, Fields], PerformSubstitution]
] = {
    "HasNodeParams": _has_node_parameters,
    "ReplaceString": _replaced_string,
    "RewrittenYaml": _rewritten_yaml,
}
"""The substitutions by their classes' names."""

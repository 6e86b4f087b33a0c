"""`<rosparam>`, and nodes that run `rosparam load`: parameters from YAML.

ROS wiki: roslaunch/XML/rosparam, rosparam.
"""

import os.path
import shlex
from collections.abc import Iterator

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError, missing_parameter_file
from rtron.sources.launch.common.expression_library import anonymous_to_wildcard
from rtron.sources.launch.common.yaml_tree import (
    YamlDocument,
    YamlFile,
    YamlLeaf,
    YamlTree,
    parse_yaml,
)
from rtron.sources.launch.ros1.loader_context import LoaderContext, Tag
from rtron.sources.launch.ros1.parameter_server import LoadState, join_names
from rtron.vocabulary import Evidence, LaunchNode, Parameter
from rtron.vocabulary.launch import resolve_name

_COMMANDS = frozenset({"load", "dump", "delete"})
_NAMESPACE_ENTRY = "_ns"


def read_rosparam(tag: Tag, context: LoaderContext, state: LoadState) -> None:
    """Do what a `<rosparam>` says in a scope; raise InputError for what roslaunch refuses."""
    command = tag.optional("command") or "load"
    if command not in _COMMANDS:
        tag.fail(f"command: '{command}' is none of {', '.join(sorted(_COMMANDS))}")
    param = join_names(tag.optional("ns") or "", tag.optional("param") or "")
    name = join_names(context.namespace, param) if param else context.namespace
    if command == "load":
        _load(tag, context, state, name)
    elif command == "delete":
        _delete(tag, context, state, name)


def run_rosparam(tag: Tag, node: LaunchNode, state: LoadState) -> None:
    """Set what a node of package rosparam loads when it starts; note any other command of it."""
    words = _split_arguments(node.args)
    if words[:1] != ["load"] or len(words) not in {2, 3}:
        state.unresolved.add(
            tag, f"rosparam {node.args}: only `load FILE [NAMESPACE]` is understood"
        )
        return
    namespace = resolve_name(words[2] if len(words) > len(["load", "FILE"]) else "", node.name)
    try:
        text = state.documents.yaml(_absolute(words[1]))
    except InputError as error:
        state.unresolved.add_error(tag, error)
        return
    _note_errors(tag, state, text)
    for document in text.documents:
        for name, leaf in _leaves(_below_namespace_key(document, namespace)):
            evidence = Evidence(file=text.path, line=leaf.line)
            parameter = Parameter(value=leaf.value, evidence=evidence)
            state.parameters.set_by_node(resolve_name(name, node.name), parameter)


def _load(tag: Tag, context: LoaderContext, state: LoadState, name: str) -> None:
    substitutes = tag.boolean("subst_value")
    try:
        file = tag.optional("file")
    except UnresolvableError as error:
        _unknown(tag, state, name, InputError(str(error)))
        return
    try:
        text = _text(tag, state, file, substitutes=substitutes)
        tree = _only_document(text, needs_mapping=context.namespace == name)
    except InputError as error:
        _unknown(tag, state, name, error)
        return
    except (UnresolvableError, ValueError) as error:
        _unknown(tag, state, name, InputError(str(error)))
        return
    _note_errors(tag, state, text)
    for leaf_name, leaf in _leaves((name, tree)):
        evidence = Evidence(file=text.path, line=leaf.line)
        state.parameters.set(leaf_name, leaf.value, evidence, context.uncertainty)


def _unknown(tag: Tag, state: LoadState, name: str, error: InputError) -> None:
    state.unresolved.add_error(tag, error, missing_parameter_file(error))
    evidence = Evidence(file=tag.path, line=tag.line)
    state.parameters.set_unknown(name, str(error), evidence)


def _text(tag: Tag, state: LoadState, file: str | None, *, substitutes: bool) -> YamlFile:
    if file is not None and not substitutes:
        return state.documents.yaml(_absolute(file))
    text = state.documents.text(_absolute(file)) if file is not None else tag.text()
    if substitutes:
        text = anonymous_to_wildcard(tag.substitution.replace(text))
    if file is not None:
        return parse_yaml(text, _absolute(file))
    return parse_yaml(text, tag.path, tag.line)


def _only_document(text: YamlFile, *, needs_mapping: bool) -> YamlTree:
    if len(text.documents) > 1:
        raise InputError("has more than one YAML document", path=text.path)
    document = text.documents[0] if text.documents else None
    if isinstance(document, YamlLeaf) and needs_mapping:
        raise InputError(
            "is no mapping, and no 'param' names it", path=text.path, line=document.line
        )
    return {} if document is None else document


def _delete(tag: Tag, context: LoaderContext, state: LoadState, name: str) -> None:
    if tag.element.get("file") is not None:
        tag.fail("deletes, and a file has no meaning there")
    if not context.uncertainty:
        state.parameters.deleted.append(anonymous_to_wildcard(resolve_name(name, "/rosparam")))


def _note_errors(tag: Tag, state: LoadState, text: YamlFile) -> None:
    for error in text.errors:
        state.unresolved.add_error(tag, error)


def _below_namespace_key(document: YamlDocument, namespace: str) -> tuple[str, YamlTree]:
    if not isinstance(document, dict):
        return namespace, {}
    namespace_entry = document.get(_NAMESPACE_ENTRY)
    inner = {key: value for key, value in document.items() if key != _NAMESPACE_ENTRY}
    if isinstance(namespace_entry, YamlLeaf):
        return join_names(namespace, str(namespace_entry.value)), inner
    return namespace, inner


def _leaves(named_tree: tuple[str, YamlTree]) -> Iterator[tuple[str, YamlLeaf]]:
    name, tree = named_tree
    if isinstance(tree, YamlLeaf):
        yield name, tree
        return
    for key, inner in tree.items():
        yield from _leaves((join_names(name, key), inner))


def _split_arguments(args: str) -> list[str]:
    try:
        return shlex.split(args)
    except ValueError:
        return []


def _absolute(file: str) -> str:
    return os.path.join(os.getcwd(), file)  # noqa: PTH109, PTH118 - keep `..`

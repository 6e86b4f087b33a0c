"""`<rosparam>`, and nodes that run `rosparam load`: parameters from YAML.

ROS wiki: roslaunch/XML/rosparam, rosparam.
"""

import os.path
import shlex
from collections.abc import Iterator

from rtron.errors import InputError
from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.yaml_tree import (
    YamlDocument,
    YamlLeaf,
    YamlText,
    YamlTree,
    parse_yaml,
)
from rtron.sources.launch.ros1.load_state import Reading
from rtron.sources.launch.ros1.loader_context import Scope
from rtron.sources.launch.ros1.parameter_server import join_names
from rtron.sources.launch.ros1.substitution_args import as_pattern
from rtron.sources.launch.ros1.tag import Tag
from rtron.vocabulary import Evidence, LaunchNode, Parameter
from rtron.vocabulary.launch import resolve_name

_COMMANDS = frozenset({"load", "dump", "delete"})
_NAMESPACE_KEY = "_ns"


def read_rosparam(tag: Tag, scope: Scope, reading: Reading) -> None:
    """Do what a `<rosparam>` says in a scope; raise InputError for what roslaunch refuses."""
    command = tag.optional("command") or "load"
    if command not in _COMMANDS:
        tag.fault(f"command: '{command}' is none of {', '.join(sorted(_COMMANDS))}")
    param = join_names(tag.optional("ns") or "", tag.optional("param") or "")
    name = join_names(scope.namespace, param) if param else scope.namespace
    if command == "load":
        _load(tag, scope, reading, name)
    elif command == "delete":
        _delete(tag, scope, reading, name)


def run_rosparam(tag: Tag, node: LaunchNode, reading: Reading) -> None:
    """Set what a node of package rosparam loads when it starts; note any other command of it."""
    words = _words(node.args)
    if words[:1] != ["load"] or len(words) not in {2, 3}:
        reading.notes.add(tag, f"rosparam {node.args}: only `load FILE [NAMESPACE]` is understood")
        return
    namespace = resolve_name(words[2] if len(words) > len(["load", "FILE"]) else "", node.name)
    try:
        text = reading.documents.yaml(_absolute(words[1]))
    except InputError as error:
        reading.notes.add_error(tag, error)
        return
    _note_faults(tag, reading, text)
    for document in text.documents:
        for name, leaf in _flat(_below_own_namespace(document, namespace)):
            evidence = Evidence(file=text.path, line=leaf.line)
            parameter = Parameter(value=leaf.value, evidence=evidence)
            reading.parameters.set_late(resolve_name(name, node.name), parameter)


def _load(tag: Tag, scope: Scope, reading: Reading, name: str) -> None:
    substitutes = tag.boolean("subst_value")
    try:
        file = tag.optional("file")
    except UnresolvableError as error:
        _unknown(tag, reading, name, InputError(str(error)))
        return
    try:
        text = _text(tag, reading, file, substitutes=substitutes)
        tree = _only_document(text, needs_mapping=scope.namespace == name)
    except InputError as error:
        _unknown(tag, reading, name, error)
        return
    except (UnresolvableError, ValueError) as error:
        _unknown(tag, reading, name, InputError(str(error)))
        return
    _note_faults(tag, reading, text)
    for leaf_name, leaf in _flat((name, tree)):
        evidence = Evidence(file=text.path, line=leaf.line)
        reading.parameters.set(leaf_name, leaf.value, evidence, scope.doubt)


def _unknown(tag: Tag, reading: Reading, name: str, error: InputError) -> None:
    reading.notes.add_error(tag, error)
    evidence = Evidence(file=tag.path, line=tag.line)
    reading.parameters.set_unknown(name, str(error), evidence)


def _text(tag: Tag, reading: Reading, file: str | None, *, substitutes: bool) -> YamlText:
    if file is not None and not substitutes:
        return reading.documents.yaml(_absolute(file))
    text = reading.documents.text(_absolute(file)) if file is not None else tag.text()
    if substitutes:
        text = as_pattern(tag.substitution.replace(text))
    if file is not None:
        return parse_yaml(text, _absolute(file))
    return parse_yaml(text, tag.path, tag.line)


def _only_document(text: YamlText, *, needs_mapping: bool) -> YamlTree:
    if len(text.documents) > 1:
        raise InputError("has more than one YAML document", path=text.path)
    document = text.documents[0] if text.documents else None
    if isinstance(document, YamlLeaf) and needs_mapping:
        raise InputError(
            "is no mapping, and no 'param' names it", path=text.path, line=document.line
        )
    return {} if document is None else document


def _delete(tag: Tag, scope: Scope, reading: Reading, name: str) -> None:
    if tag.element.get("file") is not None:
        tag.fault("deletes, and a file has no meaning there")
    if not scope.doubt:
        reading.parameters.deleted.append(as_pattern(resolve_name(name, "/rosparam")))


def _note_faults(tag: Tag, reading: Reading, text: YamlText) -> None:
    for fault in text.faults:
        reading.notes.add_error(tag, fault)


def _below_own_namespace(document: YamlDocument, namespace: str) -> tuple[str, YamlTree]:
    if not isinstance(document, dict):
        return namespace, {}
    own = document.get(_NAMESPACE_KEY)
    inner = {key: value for key, value in document.items() if key != _NAMESPACE_KEY}
    if isinstance(own, YamlLeaf):
        return join_names(namespace, str(own.value)), inner
    return namespace, inner


def _flat(named: tuple[str, YamlTree]) -> Iterator[tuple[str, YamlLeaf]]:
    name, tree = named
    if isinstance(tree, YamlLeaf):
        yield name, tree
        return
    for key, inner in tree.items():
        yield from _flat((join_names(name, key), inner))


def _words(args: str) -> list[str]:
    try:
        return shlex.split(args)
    except ValueError:
        return []


def _absolute(file: str) -> str:
    return os.path.join(os.getcwd(), file)  # noqa: PTH109, PTH118 - keep `..`

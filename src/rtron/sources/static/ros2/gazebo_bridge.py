"""The bridge between ROS 2 and Gazebo: what its YAML file, parameters and arguments let it carry.

Source: the README of ros_gz_bridge; what it refuses, its src/bridge_config.cpp.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import Declaration, DeclarationKind, NodeInterface, NodeSite
from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree, parse_yaml
from rtron.sources.static.ros2.parameter_values import given_value
from rtron.vocabulary import Evidence, ParameterValue, Resolution, Unresolved
from rtron.vocabulary.remap_rules import expanded

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_BOTH = (_PUBLISH, _SUBSCRIBE)
_WAYS = {"GZ_TO_ROS": (_PUBLISH,), "ROS_TO_GZ": (_SUBSCRIBE,), "BIDIRECTIONAL": _BOTH}
_SIGNS = {"[": (_PUBLISH,), "]": (_SUBSCRIBE,), "@": _BOTH}
_ARGUMENT = re.compile(r"([^@\[\]]+)@([^@\[\]]+)([@\[\]])[^@\[\]]+")
_SERVICE = re.compile(r"([^@\[\]]+)@([^@\[\]]+/srv/[^@\[\]]+)(@[^@\[\]]+@[^@\[\]]+)?")
_FILE, _NAMES = "config_file", "bridge_names"
_KEYS = ("topic_name", "ros_topic_name", "gz_topic_name", "ros_type_name", "gz_type_name")
_TYPES = _KEYS[3:]
_Placed: TypeAlias = tuple[Mapping[str, object], tuple[Evidence, ...]]


def bridge(
    site: NodeSite, place: Evidence, files: WorkspaceFiles, made: Mapping[str, YamlTree]
) -> NodeInterface:
    """Return the topics that a bridge carries; what cannot be read, or is refused, is noted.

    `made` are the files that the launch makes.
    """
    entries: list[_Placed] = [(entry, (place,)) for entry in _of_parameters(site)]
    notes: list[Unresolved] = []
    path = given_value(site, site.name, _FILE)
    try:
        read = list(_of_file(str(path), files, made)) if path is not None else []
        entries += [(entry, (place, Evidence(file=str(path)))) for entry in read]
    except InputError as error:
        notes.append(_note(site, str(error), place))
    notes += [_note(site, fault, *places) for entry, places in entries for fault in _faults(entry)]
    carried = (d for e, places in entries if not any(_faults(e)) for d in _of(e, site, *places))
    declared = (*_of_arguments(site, place), *carried)
    return NodeInterface(declarations=declared, unresolved=tuple(notes))


def _note(site: NodeSite, why: str, *places: Evidence) -> Unresolved:
    return Unresolved(what=f"topics of {site.name}", why=why, evidence=places)


def _of_arguments(site: NodeSite, place: Evidence) -> Iterator[Declaration]:
    for word in site.args:
        service, topic = _SERVICE.fullmatch(word), _ARGUMENT.fullmatch(word)
        if service:
            yield _declared(DeclarationKind.SERVICE, site, service[1], service[2], place)
        for kind in _SIGNS[topic[3]] if topic and not service else ():
            yield _declared(kind, site, topic[1], topic[2], place)  # type: ignore[index]


def _of_parameters(site: NodeSite) -> Iterator[Mapping[str, object]]:
    """Yield the entries that `bridges.NAME.KEY` makes for each of `bridge_names`."""
    names = given_value(site, site.name, _NAMES)
    for name in names if isinstance(names, (list, tuple)) else ():
        found = {key: _below(site, name, key) for key in (*_KEYS, "direction")}
        yield {key: value for key, value in found.items() if value is not None}


def _below(site: NodeSite, name: object, key: str) -> ParameterValue | None:
    return given_value(site, site.name, f"bridges.{name}.{key}")


def _of_file(
    path: str, files: WorkspaceFiles, made: Mapping[str, YamlTree]
) -> Iterator[Mapping[str, object]]:
    text = None if path in made else files.text(Path(path))
    if text is None and path not in made:
        raise InputError("is not in the folders that are read", path=path)
    documents = (made[path],) if text is None else parse_yaml(text, path).documents
    for document in documents:
        entries = document.value if isinstance(document, YamlLeaf) else []
        for entry in entries if isinstance(entries, list) else []:
            yield entry if isinstance(entry, Mapping) else {}


def _faults(entry: Mapping[str, object]) -> Iterator[str]:
    """Yield why the bridge refuses an entry."""
    if any(entry.get(key) in {None, ""} for key in _TYPES):
        yield f"the bridge refuses an entry without {' and '.join(_TYPES)}"
    if entry.get("topic_name") and (entry.get("ros_topic_name") or entry.get("gz_topic_name")):
        yield "the bridge refuses an entry with topic_name and another name"
    if str(entry.get("direction", "BIDIRECTIONAL")) not in _WAYS:
        yield f"the bridge knows no direction {entry['direction']}"


def _of(entry: Mapping[str, object], site: NodeSite, *places: Evidence) -> Iterator[Declaration]:
    names = (entry.get(key) for key in ("topic_name", "ros_topic_name", "gz_topic_name"))
    name = next((str(name) for name in names if name), "{?}")
    for kind in _WAYS[str(entry.get("direction", "BIDIRECTIONAL"))]:
        yield _declared(kind, site, name, str(entry["ros_type_name"]), *places)


def _declared(
    kind: DeclarationKind, site: NodeSite, name: str, type: str, *places: Evidence
) -> Declaration:
    return Declaration(
        kind=kind,
        name=expanded(name, site.name),
        type=type,
        node=site.name,
        resolution=Resolution.SYMBOLIC if "{" in name else Resolution.LITERAL,
        evidence=places,
    )

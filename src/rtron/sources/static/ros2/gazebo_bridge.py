"""The bridge between ROS 2 and Gazebo: what its YAML file, parameters and arguments let it carry.

Source: the README of ros_gz_bridge; what it refuses, its src/bridge_config.cpp.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import (
    Declaration,
    DeclarationKind,
    GazeboTopic,
    NodeInterface,
    NodeSite,
)
from rtron.sources.launch.common.yaml_tree import YamlLeaf, YamlTree, parse_yaml
from rtron.sources.static.ros2.endpoints import parameter_value
from rtron.sources.static.ros2.gazebo_topics import gazebo_name
from rtron.vocabulary import Evidence, ParameterValue, Resolution, UnresolvedItem
from rtron.vocabulary.remap_rules import expand_name

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_BOTH = (_PUBLISH, _SUBSCRIBE)
_KINDS_BY_DIRECTION = {"GZ_TO_ROS": (_PUBLISH,), "ROS_TO_GZ": (_SUBSCRIBE,), "BIDIRECTIONAL": _BOTH}
_KINDS_BY_SIGN = {"[": (_PUBLISH,), "]": (_SUBSCRIBE,), "@": _BOTH}
_ARGUMENT = re.compile(r"([^@\[\]]+)@([^@\[\]]+)([@\[\]])([^@\[\]]+)")
_SERVICE = re.compile(r"([^@\[\]]+)@([^@\[\]]+/srv/[^@\[\]]+)(@[^@\[\]]+@[^@\[\]]+)?")
_FILE, _NAMES = "config_file", "bridge_names"
_KEYS = ("topic_name", "ros_topic_name", "gz_topic_name", "ros_type_name", "gz_type_name")
_TYPES = _KEYS[3:]
_LocatedEntry: TypeAlias = tuple[Mapping[str, object], tuple[Evidence, ...]]


def bridge_interface(
    site: NodeSite,
    location: Evidence,
    files: WorkspaceSources,
    generated_files: Mapping[str, YamlTree],
) -> NodeInterface:
    """Return the topics that a bridge carries; what cannot be read, or is refused, is noted.

    `generated_files` are the files that the launch makes.
    """
    entries: list[_LocatedEntry] = [(entry, (location,)) for entry in _parameter_entries(site)]
    notes: list[UnresolvedItem] = []
    path = parameter_value(site, site.name, _FILE)
    try:
        read = list(_file_entries(str(path), files, generated_files)) if path is not None else []
        entries += [(entry, (location, Evidence(file=str(path)))) for entry in read]
    except InputError as error:
        notes.append(_note(site, str(error), location))
    notes += [
        _note(site, problem, *locations)
        for entry, locations in entries
        for problem in _entry_problems(entry)
    ]
    valid = [each for each in entries if not any(_entry_problems(each[0]))]
    bridged = (
        d for entry, locations in valid for d in _entry_declarations(entry, site, *locations)
    )
    declared = (*_argument_declarations(site, location), *bridged)
    topics = (*_argument_topics(site, location), *_entry_topics(valid, site))
    return NodeInterface(declarations=declared, unresolved=tuple(notes), gazebo_topics=topics)


def _argument_topics(site: NodeSite, location: Evidence) -> Iterator[GazeboTopic]:
    for topic in filter(None, map(_ARGUMENT.fullmatch, site.args)):
        yield _gazebo_topic(topic[1], topic[4], _KINDS_BY_SIGN[topic[3]], site, location)


def _entry_topics(entries: Iterable[_LocatedEntry], site: NodeSite) -> Iterator[GazeboTopic]:
    """Yield Gazebo's topics of entries; none where the bridge makes other names of them."""
    is_expanded = parameter_value(site, site.name, "expand_gz_topic_names") not in {None, False}
    for entry, locations in () if is_expanded else entries:
        names = (entry.get(key) for key in ("topic_name", "gz_topic_name", "ros_topic_name"))
        name = next((str(name) for name in names if name), "")
        kinds = _KINDS_BY_DIRECTION[str(entry.get("direction", "BIDIRECTIONAL"))]
        if "{" not in name:
            yield _gazebo_topic(name, str(entry["gz_type_name"]), kinds, site, *locations)


def _gazebo_topic(
    name: str, type: str, kinds: Iterable[DeclarationKind], site: NodeSite, *locations: Evidence
) -> GazeboTopic:
    return GazeboTopic(
        name=gazebo_name(name),
        type=type.rpartition(".")[2],
        to_ros=_PUBLISH in kinds,
        to_gazebo=_SUBSCRIBE in kinds,
        bridge=site.name,
        evidence=locations,
    )


def _note(site: NodeSite, why: str, *locations: Evidence) -> UnresolvedItem:
    return UnresolvedItem(what=f"topics of {site.name}", why=why, evidence=locations)


def _argument_declarations(site: NodeSite, location: Evidence) -> Iterator[Declaration]:
    for word in site.args:
        service, topic = _SERVICE.fullmatch(word), _ARGUMENT.fullmatch(word)
        if service:
            yield _declaration(DeclarationKind.SERVICE, site, service[1], service[2], location)
        for kind in _KINDS_BY_SIGN[topic[3]] if topic and not service else ():
            yield _declaration(kind, site, topic[1], topic[2], location)  # type: ignore[index]


def _parameter_entries(site: NodeSite) -> Iterator[Mapping[str, object]]:
    """Yield the entries that `bridges.NAME.KEY` makes for each of `bridge_names`."""
    names = parameter_value(site, site.name, _NAMES)
    for name in names if isinstance(names, (list, tuple)) else ():
        entry = {key: _bridge_parameter(site, name, key) for key in (*_KEYS, "direction")}
        yield {key: value for key, value in entry.items() if value is not None}


def _bridge_parameter(site: NodeSite, name: object, key: str) -> ParameterValue | None:
    return parameter_value(site, site.name, f"bridges.{name}.{key}")


def _file_entries(
    path: str, files: WorkspaceSources, generated_files: Mapping[str, YamlTree]
) -> Iterator[Mapping[str, object]]:
    text = None if path in generated_files else files.read_text(Path(path))
    if text is None and path not in generated_files:
        raise InputError("is not in the folders that are read", path=path)
    documents = (generated_files[path],) if text is None else parse_yaml(text, path).documents
    for document in documents:
        entries = document.value if isinstance(document, YamlLeaf) else []
        for entry in entries if isinstance(entries, list) else []:
            yield entry if isinstance(entry, Mapping) else {}


def _entry_problems(entry: Mapping[str, object]) -> Iterator[str]:
    """Yield why the bridge refuses an entry."""
    if any(entry.get(key) in {None, ""} for key in _TYPES):
        yield f"the bridge refuses an entry without {' and '.join(_TYPES)}"
    if entry.get("topic_name") and (entry.get("ros_topic_name") or entry.get("gz_topic_name")):
        yield "the bridge refuses an entry with topic_name and another name"
    if str(entry.get("direction", "BIDIRECTIONAL")) not in _KINDS_BY_DIRECTION:
        yield f"the bridge knows no direction {entry['direction']}"


def _entry_declarations(
    entry: Mapping[str, object], site: NodeSite, *locations: Evidence
) -> Iterator[Declaration]:
    names = (entry.get(key) for key in ("topic_name", "ros_topic_name", "gz_topic_name"))
    name = next((str(name) for name in names if name), "{?}")
    for kind in _KINDS_BY_DIRECTION[str(entry.get("direction", "BIDIRECTIONAL"))]:
        yield _declaration(kind, site, name, str(entry["ros_type_name"]), *locations)


def _declaration(
    kind: DeclarationKind, site: NodeSite, name: str, type: str, *locations: Evidence
) -> Declaration:
    return Declaration(
        kind=kind,
        name=expand_name(name, site.name),
        type=type,
        node=site.name,
        resolution=Resolution.SYMBOLIC if "{" in name else Resolution.LITERAL,
        evidence=locations,
    )

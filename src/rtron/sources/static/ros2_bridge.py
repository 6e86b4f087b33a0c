"""The bridge between ROS 2 and Gazebo: its topics are in a YAML file or among its arguments.

Source: the README of ros_gz_bridge.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.reading import WorkspaceFiles
from rtron.sources.declaration import Declaration, DeclarationKind, NodeInterface, NodeSite
from rtron.sources.launch.yaml_text import YamlLeaf, parse_yaml
from rtron.sources.static.ros2_given import given_value
from rtron.vocabulary import Evidence, Resolution, Unresolved
from rtron.vocabulary.remap_rules import expanded

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_BOTH = (_PUBLISH, _SUBSCRIBE)
_WAYS = {"GZ_TO_ROS": (_PUBLISH,), "ROS_TO_GZ": (_SUBSCRIBE,), "BIDIRECTIONAL": _BOTH}
_SIGNS = {"[": (_PUBLISH,), "]": (_SUBSCRIBE,), "@": _BOTH}
_ARGUMENT = re.compile(r"([^@\[\]]+)@([^@\[\]]+)([@\[\]])[^@\[\]]+")
_FILE = "config_file"


def bridge(site: NodeSite, place: Evidence, files: WorkspaceFiles) -> NodeInterface:
    """Return the topics that a bridge carries; a file that cannot be read is noted."""
    declared = [*_of_arguments(site, place)]
    path = given_value(site, site.name, _FILE)
    if path is None:
        return NodeInterface(declarations=tuple(declared))
    try:
        declared += _of_file(str(path), site, place, files)
    except InputError as error:
        note = Unresolved(what=f"topics of {site.name}", why=str(error), evidence=(place,))
        return NodeInterface(declarations=tuple(declared), unresolved=(note,))
    return NodeInterface(declarations=tuple(declared))


def _of_arguments(site: NodeSite, place: Evidence) -> Iterator[Declaration]:
    for word in site.args:
        found = _ARGUMENT.fullmatch(word)
        for kind in _SIGNS[found[3]] if found else ():
            yield _declared(kind, site, found[1], found[2], place)  # type: ignore[index]


def _of_file(
    path: str, site: NodeSite, place: Evidence, files: WorkspaceFiles
) -> Iterator[Declaration]:
    text = files.text(Path(path))
    if text is None:
        raise InputError("is not in the folders that are read", path=path)
    for document in parse_yaml(text, path).documents:
        entries = document.value if isinstance(document, YamlLeaf) else []
        for entry in entries if isinstance(entries, list) else []:
            if isinstance(entry, Mapping):
                yield from _of_entry(entry, site, place, Evidence(file=path))


def _of_entry(
    entry: Mapping[str, object], site: NodeSite, *places: Evidence
) -> Iterator[Declaration]:
    names = (entry.get(key) for key in ("ros_topic_name", "topic_name", "gz_topic_name"))
    name = next((str(name) for name in names if name), "{?}")
    type = str(entry.get("ros_type_name", ""))
    for kind in _WAYS.get(str(entry.get("direction", "BIDIRECTIONAL")), _BOTH):
        yield _declared(kind, site, name, type, *places)


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

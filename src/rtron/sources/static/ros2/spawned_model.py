"""Which description a spawner of ROS 2 gives to Gazebo: a file's, a topic's, or a parameter's.

gazebo_ros (scripts/spawn_entity.py), ros_gz_sim (src/create.cpp): parameters count before options
there.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import DeclarationKind, NodeSite
from rtron.sources.models.common.arguments import option
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.ros2.endpoints import Rules
from rtron.sources.static.ros2.parameter_values import given_value
from rtron.vocabulary import Evidence, UnknownValue
from rtron.vocabulary.remap_rules import expanded

_DESCRIPTION = "robot_description"
_STRING = "std_msgs/msg/String"


@dataclass(frozen=True, slots=True)
class Spawned:
    """The text of a description, and the file it is in, or the place that spawns it."""

    text: str
    place: Evidence
    is_file: bool = False


def spawned_by(spawner: Part, parts: Iterable[Part], files: WorkspaceFiles) -> Spawned | None:
    """Return what a spawner spawns, None for what joins no node; InputError if it is not known."""
    site, place = spawner.node.site, spawner.node.evidence
    file, topic = _given(site, "file"), _given(site, "topic")
    if file:
        text = files.text(Path(file))
        if text is None:
            raise InputError("is not in the folders that are read", path=file)
        return Spawned(text, Evidence(file=file), is_file=True)
    if topic:
        name = Rules(spawner.node.rules, site.name)(expanded(topic, site.name))
        return Spawned(_published(name, parts), place)
    parameter = option(site.args, "-param --param")
    value = given_value(site, site.name, parameter) if parameter else _given(site, "string")
    return Spawned(_known(value), place) if value else None


def _given(site: NodeSite, name: str) -> str | None:
    value = given_value(site, site.name, name)
    if isinstance(value, UnknownValue):
        raise InputError(value.why)
    return str(value) if value else option(site.args, f"-{name} --{name}")


def _published(topic: str, parts: Iterable[Part]) -> str:
    """Return the description that a node sends on a topic."""
    for part in parts:
        for node in _senders(topic, part):
            value = given_value(part.node.site, node, _DESCRIPTION)
            if value is not None:
                return _known(value)
    raise InputError(f"nothing that is read publishes a known description on {topic}")


def _senders(topic: str, part: Part) -> Iterator[str]:
    for declared in part.interface.declarations:
        node = declared.node or part.node.name
        is_text = declared.kind is DeclarationKind.PUBLISH and declared.type == _STRING
        if is_text and Rules(part.node.rules, node)(declared.name) == topic:
            yield node


def _known(value: object) -> str:
    if not isinstance(value, str):
        raise InputError(value.why if isinstance(value, UnknownValue) else "it is no text")
    return value

"""Which description a spawner of ROS 2 gives to Gazebo: a file's, a topic's, or a parameter's.

gazebo_ros (scripts/spawn_entity.py), ros_gz_sim (src/create.cpp): parameters count before options
there.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import DeclarationKind, NodeSite
from rtron.sources.models.common.arguments import option
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.ros2.endpoints import RemapRules, parameter_value
from rtron.vocabulary import Evidence, UnknownValue
from rtron.vocabulary.remap_rules import expand_name

DESCRIPTION = "robot_description"
_STRING = "std_msgs/msg/String"


@dataclass(frozen=True, slots=True)
class SpawnedModel:
    """The text of a description, and the file it is in, or the place that spawns it."""

    text: str
    location: Evidence
    is_file: bool = False


def find_spawned_model(
    spawner: NodePart, parts: Iterable[NodePart], files: WorkspaceSources
) -> SpawnedModel | None:
    """Return what a spawner spawns, None for what joins no node; InputError if it is not known."""
    site, location = spawner.node.site, spawner.node.evidence
    file, topic = _spawner_option(site, "file"), _spawner_option(site, "topic")
    if file:
        text = files.read_text(Path(file))
        if text is None:
            raise InputError("is not in the folders that are read", path=file)
        return SpawnedModel(text, Evidence(file=file), is_file=True)
    if topic:
        name = RemapRules(spawner.node.process_remap_rules, site.name)(
            expand_name(topic, site.name)
        )
        text = published_description(name, parts)
        if text is None:
            raise InputError(f"nothing that is read publishes a known description on {name}")
        return SpawnedModel(text, location)
    parameter = option(site.args, "-param --param")
    value = (
        parameter_value(site, site.name, parameter)
        if parameter
        else _spawner_option(site, "string")
    )
    return SpawnedModel(_known_text(value), location) if value else None


def _spawner_option(site: NodeSite, name: str) -> str | None:
    value = parameter_value(site, site.name, name)
    if isinstance(value, UnknownValue):
        raise InputError(value.why)
    return str(value) if value else option(site.args, f"-{name} --{name}")


def published_description(topic: str, parts: Iterable[NodePart]) -> str | None:
    """Return the description that a node sends on a topic, None without one.

    Raise InputError where it is not known.
    """
    for part in parts:
        for node in _publishing_nodes(topic, part):
            value = parameter_value(part.node.site, node, DESCRIPTION)
            if value is not None:
                return _known_text(value)
    return None


def _publishing_nodes(topic: str, part: NodePart) -> Iterator[str]:
    for declared in part.interface.declarations:
        node = declared.node or part.node.name
        is_text = declared.kind is DeclarationKind.PUBLISH and declared.type == _STRING
        if is_text and RemapRules(part.node.process_remap_rules, node)(declared.name) == topic:
            yield node


def _known_text(value: object) -> str:
    if not isinstance(value, str):
        raise InputError(value.why if isinstance(value, UnknownValue) else "it is no text")
    return value

"""Nodes of ROS 2 that are known without their source: containers, and the bridge to Gazebo."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rtron.sources.code.library_models.rclcpp.component_manager import LOADING
from rtron.sources.code.library_models.ros2_common.endpoints import PARAMETER_SERVICES
from rtron.sources.code.library_models.ros2_common.qos import PROFILES
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import (
    Declaration,
    DeclarationKind,
    MadeNode,
    NodeInterface,
    NodeSite,
    plain_value,
)
from rtron.sources.launch.common.yaml_tree import YamlTree
from rtron.sources.launch.ros2.parameters.merge import names as covers
from rtron.sources.models import Model
from rtron.sources.models.ros2.site import ros2_site
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.ros2.app_nodes import CONTAINERS
from rtron.sources.static.ros2.gazebo_bridge import bridge
from rtron.sources.static.ros2.parameter_values import given_value
from rtron.vocabulary import NodeParameter

_BRIDGE = "ros_gz_bridge"
_BRIDGES = ("parameter_bridge", "bridge_node", "ros_gz_bridge::RosGzBridge")
_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_TOPICS = (
    (_PUBLISH, "rosout", "rcl_interfaces/msg/Log"),
    (_PUBLISH, "parameter_events", "rcl_interfaces/msg/ParameterEvent"),
    (_SUBSCRIBE, "parameter_events", "rcl_interfaces/msg/ParameterEvent"),
)
_CLOCK = (_SUBSCRIBE, "clock", "rosgraph_msgs/msg/Clock")
_DESCRIPTION = "type_description_interfaces/srv/GetTypeDescription"
_DESCRIBED = {"get_type_description": _DESCRIPTION}
_EVERY = {**PARAMETER_SERVICES, **_DESCRIBED}
_EVENTS = (_PUBLISH, "/parameter_events")
"""A container does not have this, nor parameter services (rclcpp_components: ComponentManager)."""


def with_known(part: Part, files: WorkspaceFiles, made: Mapping[str, YamlTree]) -> Part:
    """Return the part of a node that is known, with what it declares; another one as it is."""
    node = part.node
    if node.package == CONTAINERS and not node.container:
        services = _services(part, node.name, {**_DESCRIBED, **LOADING})
        topics = (d for d in _topics(part, node.name) if (d.kind, d.name) != _EVENTS)
        interface = NodeInterface(declarations=(*topics, *services))
        return replace(part, interface=interface)
    if part.task is None and node.package == _BRIDGE and node.type in _BRIDGES:
        return replace(part, interface=_bridge(part, files, made))
    if part.model is not None:
        return replace(part, interface=_modelled(part, part.model))
    return part


def _modelled(part: Part, model: Model) -> NodeInterface:
    """Return what a model says, and what every node of its client library has.

    A node that a library makes for itself alone has none of it (tf2_ros: TransformListener).
    """
    found = part.interface
    used = {declared.node for declared in found.declarations if not declared.implicit}
    names = [m.name for i, m in enumerate(found.nodes) if m.name in used or not i]
    topics = [one for name in names for one in _topics(part, name, python=model.is_python)]
    of_all = _EVERY if model.parameter_services else _DESCRIBED
    services = [one for name in names for one in _services(part, name, of_all)]
    return replace(
        found,
        declarations=(*found.declarations, *topics, *services),
        parameters=tuple(_parameters(part.node.site, names)),
    )


def _parameters(site: NodeSite, names: list[str]) -> Iterator[NodeParameter]:
    """Yield what the launch gives to nodes; their defaults are not in the models.

    use_sim_time, which every node has, is off unless it is given.
    """
    for node in names:
        given = {s.name: s.value for s in site.settings if covers(s.node, node)}
        given |= dict(site.overrides) if node == names[0] else {}
        default = False if site.complete else None
        for name, value in {"use_sim_time": default, **given}.items():
            yield NodeParameter(node=node, name=name, value=plain_value(value))


def _bridge(part: Part, files: WorkspaceFiles, made: Mapping[str, YamlTree]) -> NodeInterface:
    """Return what the bridge declares; it calls itself like its package."""
    site = ros2_site(_BRIDGE, part.node.site)
    own = bridge(site, part.node.evidence, files, made)
    implied = (*_topics(part, site.name), *_services(part, site.name, _EVERY))
    node = MadeNode(name=site.name, remaps=site.remaps)
    return replace(own, nodes=(node,), declarations=(*own.declarations, *implied))


def _topics(part: Part, name: str, *, python: bool = False) -> Iterator[Declaration]:
    """Yield the topics that every node joins; rclpy hears no events of parameters."""
    clock = (_CLOCK,) if _is_simulated(part.node.site, name) else ()
    for kind, topic, type in (*_TOPICS[: 2 if python else 3], *clock):
        yield Declaration(
            kind=kind,
            name=f"/{topic}",
            type=type,
            node=name,
            qos=PROFILES[topic],
            implicit=True,
            evidence=(part.node.evidence,),
        )


def _services(part: Part, name: str, types: dict[str, str]) -> Iterator[Declaration]:
    for service, type in types.items():
        yield Declaration(
            kind=DeclarationKind.SERVICE,
            name=f"{name}/{service}",
            type=type,
            node=name,
            implicit=True,
            evidence=(part.node.evidence,),
        )


def _is_simulated(site: NodeSite, name: str) -> bool:
    return given_value(site, name, "use_sim_time") is True

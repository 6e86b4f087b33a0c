"""Nodes of ROS 2 that are known without their source, as component containers and ros_gz_bridge."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from rtron.sources.code.library_models.rclcpp.node import CONTAINER_SERVICES
from rtron.sources.code.library_models.ros2_common.endpoints import PARAMETER_SERVICES
from rtron.sources.code.library_models.ros2_common.qos import QOS_PROFILES
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import (
    CreatedNode,
    Declaration,
    DeclarationKind,
    NodeInterface,
    NodeSite,
    plain_value,
)
from rtron.sources.launch.common.yaml_tree import YamlTree
from rtron.sources.models import Model
from rtron.sources.models.common.node_site import resolve_ros2_site
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.ros2.endpoints import parameter_value
from rtron.sources.static.ros2.gazebo_bridge import bridge_interface
from rtron.sources.static.ros2.loading_commands import CONTAINER_PACKAGE
from rtron.vocabulary import NodeParameter
from rtron.vocabulary.parameters import pattern_matches

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
_DESCRIPTION_SERVICES = {"get_type_description": _DESCRIPTION}
_STANDARD_SERVICES = {**PARAMETER_SERVICES, **_DESCRIPTION_SERVICES}
_EVENTS = (_PUBLISH, "/parameter_events")
"""A container does not have this, nor parameter services (rclcpp_components: ComponentManager)."""


def add_standard_interface(
    part: NodePart, files: WorkspaceSources, generated_files: Mapping[str, YamlTree]
) -> NodePart:
    """Return the part of a node that is known, with what it declares; another one as it is."""
    node = part.node
    if node.package == CONTAINER_PACKAGE and not node.container:
        services = _standard_services(
            part, node.name, {**_DESCRIPTION_SERVICES, **CONTAINER_SERVICES}
        )
        topics = (d for d in _standard_topics(part, node.name) if (d.kind, d.name) != _EVENTS)
        interface = NodeInterface(declarations=(*topics, *services))
        return replace(part, interface=interface)
    is_bridge = node.package == _BRIDGE and node.type in _BRIDGES
    if is_bridge and (part.task is None or part.is_cut):
        return replace(part, interface=_bridge_interface(part, files, generated_files))
    if part.model is not None:
        return replace(part, interface=_model_interface(part, part.model))
    return part


def _model_interface(part: NodePart, model: Model) -> NodeInterface:
    """Return what a model says, and what every node of its client library has.

    A node that a library makes for itself alone has none of it (tf2_ros: TransformListener).
    """
    interface = part.interface
    declaring_nodes = {
        declared.node for declared in interface.declarations if not declared.implicit
    }
    names = [m.name for i, m in enumerate(interface.nodes) if m.name in declaring_nodes or not i]
    topics = [
        declaration
        for name in names
        for declaration in _standard_topics(part, name, python=model.is_python)
    ]
    standard_services = _STANDARD_SERVICES if model.parameter_services else _DESCRIPTION_SERVICES
    services = [
        declaration
        for name in names
        for declaration in _standard_services(part, name, standard_services)
    ]
    return replace(
        interface,
        declarations=(*interface.declarations, *topics, *services),
        parameters=tuple(_launch_parameters(part.node.site, names)),
    )


def _launch_parameters(site: NodeSite, names: list[str]) -> Iterator[NodeParameter]:
    """Yield what the launch gives to nodes; their defaults are not in the models.

    use_sim_time, which every node has, is off unless it is given.
    """
    for node in names:
        values = {s.name: s.value for s in site.settings if pattern_matches(s.node, node)}
        values |= dict(site.overrides) if node == names[0] else {}
        default = False if site.parameters_complete else None
        for name, value in {"use_sim_time": default, **values}.items():
            yield NodeParameter(node=node, name=name, value=plain_value(value))


def _bridge_interface(
    part: NodePart, files: WorkspaceSources, generated_files: Mapping[str, YamlTree]
) -> NodeInterface:
    """Return what the bridge declares; it calls itself like its package."""
    site = resolve_ros2_site(_BRIDGE, part.node.site)
    bridged = bridge_interface(site, part.node.evidence, files, generated_files)
    standard = (
        *_standard_topics(part, site.name),
        *_standard_services(part, site.name, _STANDARD_SERVICES),
    )
    node = CreatedNode(name=site.name, remaps=site.remaps)
    return replace(bridged, nodes=(node,), declarations=(*bridged.declarations, *standard))


def _standard_topics(part: NodePart, name: str, *, python: bool = False) -> Iterator[Declaration]:
    """Yield the topics that every node joins; rclpy hears no events of parameters."""
    clock = (_CLOCK,) if _is_simulated(part.node.site, name) else ()
    for kind, topic, type in (*_TOPICS[: 2 if python else 3], *clock):
        yield Declaration(
            kind=kind,
            name=f"/{topic}",
            type=type,
            node=name,
            qos=QOS_PROFILES[topic],
            implicit=True,
            evidence=(part.node.evidence,),
        )


def _standard_services(part: NodePart, name: str, types: dict[str, str]) -> Iterator[Declaration]:
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
    return parameter_value(site, name, "use_sim_time") is True

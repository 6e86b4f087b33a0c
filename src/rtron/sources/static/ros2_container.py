"""The container that loads components: a node of rclcpp_components, known without its source.

docs.ros.org: "Composing multiple nodes in a single process"; rclcpp: what every node declares.
"""

from collections.abc import Iterator

from rtron.sources.code.natives.ros2_endpoints import PARAMETER_SERVICES
from rtron.sources.code.natives.ros2_qos import PROFILES
from rtron.sources.declaration import Declaration, DeclarationKind, NodeInterface, NodeSite
from rtron.sources.launch2.parameters import names
from rtron.sources.static.part import Part

PACKAGE = "rclcpp_components"

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_TOPICS = (
    (_PUBLISH, "rosout", "rcl_interfaces/msg/Log"),
    (_PUBLISH, "parameter_events", "rcl_interfaces/msg/ParameterEvent"),
    (_SUBSCRIBE, "parameter_events", "rcl_interfaces/msg/ParameterEvent"),
)
_CLOCK = (_SUBSCRIBE, "clock", "rosgraph_msgs/msg/Clock")
_SERVICES = {
    **PARAMETER_SERVICES,
    "get_type_description": "type_description_interfaces/srv/GetTypeDescription",
    "_container/load_node": "composition_interfaces/srv/LoadNode",
    "_container/unload_node": "composition_interfaces/srv/UnloadNode",
    "_container/list_nodes": "composition_interfaces/srv/ListNodes",
}


def container_of(part: Part) -> NodeInterface:
    """Return what a container declares, all of it implicit."""
    return NodeInterface(declarations=tuple(_declared(part)))


def _declared(part: Part) -> Iterator[Declaration]:
    name, place = part.node.name, (part.node.evidence,)
    clock = (_CLOCK,) if _is_simulated(part.node.site) else ()
    for kind, topic, type in (*_TOPICS, *clock):
        yield Declaration(
            kind=kind,
            name=f"/{topic}",
            type=type,
            node=name,
            qos=PROFILES[topic],
            implicit=True,
            evidence=place,
        )
    for service, type in _SERVICES.items():
        yield Declaration(
            kind=DeclarationKind.SERVICE,
            name=f"{name}/{service}",
            type=type,
            node=name,
            implicit=True,
            evidence=place,
        )


def _is_simulated(site: NodeSite) -> bool:
    set_for_it = (s for s in site.settings if names(s.node, site.name))
    return [s.value for s in set_for_it if s.name == "use_sim_time"][-1:] == [True]

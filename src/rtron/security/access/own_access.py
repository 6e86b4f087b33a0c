"""What RTron's own processes may do, and those that a person starts beside the app."""

from collections.abc import Iterable, Iterator

from rtron.security.access.names import is_legal_name, node_rights
from rtron.security.access.plan_rights import watched_topics
from rtron.security.access.rights import AccessRight, NodeAccess, ProcessAccess, RightKind
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    VERIFY_NODE,
    InteractionGraph,
    Mode,
    Plan,
    build_streams,
)

OPERATOR_PROCESS = "/rtron_operator"
LAUNCH_PROCESS = "/"
"""rcl's name of the enclave of a process that names none, as `ros2 launch` is."""

_GUARD_NODES = (GUARD_NODE, BULK_NODE, SUPERVISOR_NODE)
_SCAN_NODES, _TOOL_NODES, _LAUNCH_NODES = "/_rtron_scan_*", "/_ros2cli_*", "/launch_ros_*"
NODES_OF_OWN_PROCESSES = {
    GUARD_NODE: (*_GUARD_NODES, f"{PRIVATE_ROOT}/*"),
    VERIFY_NODE: (VERIFY_NODE, _SCAN_NODES),
    OPERATOR_PROCESS: (_TOOL_NODES, "/rosbag2_recorder"),
    LAUNCH_PROCESS: (_LAUNCH_NODES,),
}
"""The names and patterns of the nodes in processes that no node of the app has given its name."""
_READING_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "get_type_description",
    "get_state",
)
_LOADING_SERVICES = ("load_node", "unload_node", "list_nodes")
_LOAD_NODE_TYPE = "composition_interfaces/srv/LoadNode"


def guard_access(plan: Plan) -> ProcessAccess:
    """Return what the guard may do: all of its processes are one, and share one enclave.

    What begins with `/rtron/` is its own. Of the public names, it has those of its streams, and
    reads its events, frames and stop buttons.
    """
    private = (AccessRight(kind, f"{PRIVATE_ROOT}/*") for kind in RightKind)
    diagnostics = AccessRight(RightKind.PUBLISH, "/diagnostics")
    return _process(GUARD_NODE, (*private, diagnostics, *_public_rights(plan)), *_GUARD_NODES)


def _public_rights(plan: Plan) -> Iterator[AccessRight]:
    for stream in build_streams(plan):
        if stream.is_ros2_action:
            kind = RightKind.EXECUTE if stream.mode is Mode.ENFORCE else RightKind.CALL
            yield AccessRight(kind, stream.topic)
        else:
            yield AccessRight(RightKind.SUBSCRIBE, stream.topic)
            if stream.mode is Mode.ENFORCE:
                yield AccessRight(RightKind.PUBLISH, stream.topic)
        if stream.done:
            yield AccessRight(RightKind.SUBSCRIBE, stream.done)
            yield AccessRight(RightKind.CALL, stream.done)
    for topic, _ in watched_topics(plan):
        yield AccessRight(RightKind.SUBSCRIBE, topic)


def verify_access() -> ProcessAccess:
    """Return what `rtron verify` and `rtron scan --live` may do: they look, and try themselves."""
    probe = f"{PRIVATE_ROOT}/self_*"
    kinds = (RightKind.PUBLISH, RightKind.SUBSCRIBE, RightKind.REPLY, RightKind.REQUEST)
    rights = (AccessRight(kind, probe) for kind in kinds)
    return _process(VERIFY_NODE, rights, VERIFY_NODE, _SCAN_NODES)


def operator_access() -> ProcessAccess:
    """Return what a person's tools may do, such as `ros2 topic echo`: read everything."""
    requests = (AccessRight(RightKind.REQUEST, f"/*/{each}") for each in _READING_SERVICES)
    rights = (AccessRight(RightKind.SUBSCRIBE, "/*"), *requests)
    return _process(OPERATOR_PROCESS, rights, _TOOL_NODES)


def launch_access(graph: InteractionGraph) -> ProcessAccess | None:
    """Return what `ros2 launch` itself does: it loads components; None if there is no container.

    Whoever names no enclave has this one, so it is there only where it is needed.
    """
    containers = (each.node for each in graph.services if each.type == _LOAD_NODE_TYPE)
    names = {f"{each}/_container/{verb}" for each in containers for verb in _LOADING_SERVICES}
    loading = [AccessRight(RightKind.REQUEST, name) for name in names if is_legal_name(name)]
    return _process(LAUNCH_PROCESS, loading, _LAUNCH_NODES) if loading else None


def _process(name: str, rights: Iterable[AccessRight], *nodes: str) -> ProcessAccess:
    """Return a process with rights, and with what the library does for the nodes that it has."""
    library = frozenset(right for node in nodes for right in node_rights(node))
    access = NodeAccess(node=name, rights=library.union(rights), library=library)
    return ProcessAccess(name=name, nodes=(access,))

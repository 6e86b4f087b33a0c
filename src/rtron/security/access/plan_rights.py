"""What a plan makes of what a node does: its ends of a guarded stream move to private names."""

from collections.abc import Iterable, Iterator

from rtron.security.access.rights import (
    AccessRight,
    NodeAccess,
    ProcessAccess,
    RightKind,
    is_legal_name,
    node_rights,
)
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    VERIFY_NODE,
    Flow,
    InteractionGraph,
    Mode,
    Plan,
    Stream,
    build_streams,
    flow_topic,
    lease_topic,
    matches_node,
    output_topic,
)

_INTO_GUARD = (RightKind.PUBLISH, RightKind.CALL)


class PlanRights:
    """The enforced streams of a plan, and who may use which name for them."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        enforced = (each for each in build_streams(plan) if each.mode is Mode.ENFORCE)
        self._streams = {stream.topic: stream for stream in enforced}

    def nodes(self) -> tuple[str, ...]:
        """Return the nodes and patterns that the plan gives a right, each once."""
        return tuple(dict.fromkeys(node for node, _ in self._planned()))

    def planned(self, node: str) -> Iterator[AccessRight]:
        """Yield what the plan itself says that a node does, under public names."""
        return (right for name, right in self._planned() if matches_node(name, node))

    def lease_rights(self, node: str) -> Iterator[AccessRight]:
        """Yield the private names on which a node asks for leases and hears the answers."""
        for grcn in self._plan.grcn:
            if grcn.lease and any(matches_node(flow.publisher, node) for flow in grcn.flows):
                yield AccessRight(RightKind.PUBLISH, lease_topic(grcn.lease, "request"))
                yield AccessRight(RightKind.SUBSCRIBE, lease_topic(grcn.lease, "answer"))
                yield AccessRight(RightKind.SUBSCRIBE, lease_topic(grcn.lease, "status"))

    def granted(self, node: str, right: AccessRight) -> AccessRight | None:
        """Return what a node may do instead of what it does by itself; None if nothing.

        Nobody may publish the public name of a stream, unless the plan lets strangers through:
        the guard does. Who subscribes it without being a successor may.
        """
        stream = self._streams.get(right.name)
        if stream is None or stream.is_ros2_action != _is_of_action(right):
            return right
        flow = _flow_of(stream, node)
        if flow:
            return AccessRight(right.kind, flow_topic(stream.topic, flow.name))
        is_input = right.kind in _INTO_GUARD
        if any(matches_node(each, node) for each in stream.successors):
            return None if is_input else AccessRight(right.kind, output_topic(stream.topic))
        is_free = right.kind is RightKind.SUBSCRIBE or (is_input and not stream.block_unapproved)
        return right if is_free else None

    def _planned(self) -> Iterator[tuple[str, AccessRight]]:
        for stream in self._streams.values():
            publish, subscribe = _stream_kinds(stream)
            for flow in stream.flows:
                yield flow.publisher, AccessRight(publish, stream.topic)
            for node in stream.successors:
                yield node, AccessRight(subscribe, stream.topic)
        for topic, publisher in watched_topics(self._plan):
            yield publisher, AccessRight(RightKind.PUBLISH, topic)


def watched_topics(plan: Plan) -> Iterator[tuple[str, str]]:
    """Yield each topic that the guard only reads, with its publisher: events, frames, buttons."""
    for event in plan.msrcn.eflows if plan.msrcn else ():
        yield event.topic, event.publisher
    for frames in plan.rsrcn.iflows if plan.rsrcn else ():
        yield frames.topic, frames.publisher
    for monitor in plan.fps_monitor:
        yield monitor.topic, monitor.node
        if monitor.camera:
            yield monitor.camera.topic, monitor.camera.publisher
    for button in plan.stop_sources.buttons:
        yield button.topic, button.publisher


def _stream_kinds(stream: Stream) -> tuple[RightKind, RightKind]:
    """Return what publishers and what successors do with a stream's name."""
    if stream.is_ros2_action:
        return RightKind.CALL, RightKind.EXECUTE
    return RightKind.PUBLISH, RightKind.SUBSCRIBE


def _is_of_action(right: AccessRight) -> bool:
    return right.kind in (RightKind.CALL, RightKind.EXECUTE)


def _flow_of(stream: Stream, node: str) -> Flow | None:
    """Return a node's flow; a name goes before a pattern, as in the remaps."""
    exact = (flow for flow in stream.flows if flow.publisher == node)
    matching = (flow for flow in stream.flows if matches_node(flow.publisher, node))
    return next(exact, None) or next(matching, None)


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

"""Who may publish, subscribe, serve and call what: exactly what graph and plan say.

Deny by default: what is not known in full is not allowed, and told (`AccessDoubt`).
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping

from rtron.errors import InputError
from rtron.security.access.plan_rights import (
    OPERATOR_PROCESS,
    PlanRights,
    guard_access,
    launch_access,
    operator_access,
    verify_access,
)
from rtron.security.access.rights import (
    LONGEST_PROCESS_NAME,
    AccessDoubt,
    AccessRight,
    AppAccess,
    NodeAccess,
    ProcessAccess,
    RightKind,
    is_legal_name,
    is_legal_node,
    is_own_node,
    is_tool,
    means_own_node,
    node_rights,
    process_name,
)
from rtron.vocabulary import (
    GUARD_NODE,
    VERIFY_NODE,
    ActionRole,
    Direction,
    InteractionGraph,
    Plan,
    is_private_name,
    matches_node,
)

_ROS2 = 2
_ACTION_PART = "/_action/"
_PARTICIPANT_DIGITS = 24
"""A GID begins with its participant's 12 bytes (DDSI-RTPS 2.5, 8.2.4)."""
_LOAD_NODE = "composition_interfaces/srv/LoadNode"


def app_access(graph: InteractionGraph, plan: Plan, *, operator: bool = False) -> AppAccess:
    """Return the processes of a guarded app with their rights; `operator` adds one that reads.

    `graph` may be the app's own or that of the guarded app. InputError if either is of ROS 1, or
    if two processes would have one name.
    """
    if graph.ros != _ROS2 or plan.ros != _ROS2:
        raise InputError("is for ROS 1, which has no enclaves", help="see `rtron master`")
    rights = _AppRights(graph, PlanRights(plan))
    nodes = rights.nodes()
    processes = [guard_access(plan), verify_access()]
    processes += [launch] if (launch := launch_access(graph)) else []
    processes += [operator_access()] if operator else []
    processes += _processes(graph, nodes)
    _refuse_shared_names(processes)
    return AppAccess(
        processes=tuple(processes),
        doubts=tuple(dict.fromkeys((*rights.doubts, *_unread(graph)))),
    )


class _AppRights:
    """The rights of every node, and what is told of those that it does not get."""

    def __init__(self, graph: InteractionGraph, plan: PlanRights) -> None:
        self.doubts: list[AccessDoubt] = []
        self._plan = plan
        self._graph = graph
        self._used: dict[str, list[AccessRight]] = defaultdict(list)
        for node, right in _uses(graph):
            self._used[node].append(right)

    def nodes(self) -> tuple[NodeAccess, ...]:
        """Return the nodes of graph and plan that may run, each with its rights."""
        named = dict.fromkeys((*(node.name for node in self._graph.nodes), *self._used))
        listed = [node for node in named if self._may_run(node)]
        missing = [
            pattern
            for pattern in self._plan.nodes()
            if not any(matches_node(pattern, node) for node in listed) and not is_own_node(pattern)
        ]
        for node in missing:
            self._doubt(node, "the node", "is in the plan and not in the graph: it gets no more")
        return tuple(self._access(node) for node in (*listed, *filter(self._may_run, missing)))

    def _may_run(self, node: str) -> bool:
        if is_own_node(node):
            return False
        if is_tool(node):
            self._doubt(node, "the node", f"is a tool's: use the enclave {OPERATOR_PROCESS}")
        elif not is_legal_node(node):
            self._doubt(node, "the node", "has no name that is known before it runs")
        elif means_own_node(node):
            self._doubt(node, "the node", "is a pattern that means RTron's own nodes, too")
        elif len(process_name(node)) > LONGEST_PROCESS_NAME:
            self._doubt(node, "the node", f"has a name of more than {LONGEST_PROCESS_NAME} letters")
        else:
            return True
        return False

    def _access(self, node: str) -> NodeAccess:
        library = frozenset(node_rights(node))
        granted = {*self._granted(node, (*self._plan.planned(node), *self._used[node]))}
        granted |= {*self._plan.lease_rights(node)}
        return NodeAccess(node=node, rights=library | granted, library=library)

    def _granted(self, node: str, uses: Iterable[AccessRight]) -> Iterator[AccessRight]:
        for right in uses:
            if right in node_rights(node):
                continue
            if not is_legal_name(right.name):
                self._refuse(node, right, "is no name that is known before the app runs")
            elif is_private_name(right.name):
                self._check_private(node, right)
            elif moved := self._plan.granted(node, right):
                yield moved
            else:
                self._refuse(node, right, "the plan lets the guard alone do that")

    def _check_private(self, node: str, right: AccessRight) -> None:
        """Tell of a private name that a running app uses, if the plan gives it to another."""
        private = (self._plan.granted(node, each) for each in self._plan.planned(node))
        names = {each.name for each in private if each}
        if right.name not in names and right not in self._plan.lease_rights(node):
            self._refuse(node, right, "the plan gives this private name to others")

    def _refuse(self, node: str, right: AccessRight, why: str) -> None:
        self._doubt(node, f"{right.kind} {right.name}", why)

    def _doubt(self, node: str, what: str, why: str) -> None:
        self.doubts.append(AccessDoubt(node=node, what=what, why=why))


def _uses(graph: InteractionGraph) -> Iterator[tuple[str, AccessRight]]:
    """Yield what each node of a graph does, under the names that it has there."""
    for endpoint in graph.endpoints:
        publishes = endpoint.direction is Direction.PUBLISH
        kind = RightKind.PUBLISH if publishes else RightKind.SUBSCRIBE
        if _ACTION_PART not in endpoint.topic:
            yield endpoint.node, AccessRight(kind, endpoint.topic)
    for service in graph.services:
        if _ACTION_PART not in service.name:
            yield service.node, AccessRight(RightKind.REPLY, service.name)
    for client in graph.clients:
        if _ACTION_PART not in client.name:
            yield client.node, AccessRight(RightKind.REQUEST, client.name)
    for action in graph.actions:
        serves = action.role is ActionRole.SERVER
        yield action.node, AccessRight(RightKind.EXECUTE if serves else RightKind.CALL, action.name)


def _unread(graph: InteractionGraph) -> Iterator[AccessDoubt]:
    """Yield what the graph does not tell: it may be needed, and is not allowed."""
    if any(endpoint.gid for endpoint in graph.endpoints) and not graph.clients:
        why = "a running app does not tell who calls services: nobody may, but for actions"
        yield AccessDoubt(node="", what="clients of services", why=why)
    for node in graph.nodes:
        if node.unread and not is_own_node(node.name):
            why = "is known in part at most, and gets no more: scan it while it runs, or model it"
            yield AccessDoubt(node=node.name, what="the node", why=why)
    for item in graph.unresolved:
        yield AccessDoubt(node="", what=item.what, why=item.why)


def _processes(graph: InteractionGraph, nodes: tuple[NodeAccess, ...]) -> Iterator[ProcessAccess]:
    main = _main_nodes(graph)
    groups: dict[str, list[NodeAccess]] = defaultdict(list)
    for access in nodes:
        first = main.get(access.node, access.node)
        groups[first if _can_be_main(first) else access.node].append(access)
    for first, group in sorted(groups.items()):
        yield ProcessAccess(name=process_name(first), nodes=tuple(group))


def _main_nodes(graph: InteractionGraph) -> Mapping[str, str]:
    """Return for each node of a graph the node after which its process is called.

    A launch tells the containers; in a running app the GIDs tell the participants.
    """
    main = {node.name: node.process or node.name for node in graph.nodes}
    containers = {service.node for service in graph.services if service.type == _LOAD_NODE}
    for nodes in _nodes_of_participants(graph):
        first = min(nodes, key=lambda each: (each not in containers, each))
        main.update(dict.fromkeys(nodes, first))
    return main


def _nodes_of_participants(graph: InteractionGraph) -> Iterable[set[str]]:
    nodes: dict[str, set[str]] = defaultdict(set)
    for endpoint in graph.endpoints:
        if endpoint.gid and not is_own_node(endpoint.node) and not is_tool(endpoint.node):
            nodes[endpoint.gid[:_PARTICIPANT_DIGITS]].add(endpoint.node)
    return nodes.values()


def _can_be_main(node: str) -> bool:
    return is_legal_node(node) and len(process_name(node)) <= LONGEST_PROCESS_NAME


def _refuse_shared_names(processes: list[ProcessAccess]) -> None:
    """Refuse two processes of one name: each would have the other's rights."""
    seen: set[str] = set()
    for process in processes:
        if process.name in seen:
            reserved = (GUARD_NODE, VERIFY_NODE, OPERATOR_PROCESS)
            why = "is RTron's own" if process.name in reserved else "is used twice"
            raise InputError(f"the enclave {process.name} {why}", help="rename the node")
        seen.add(process.name)

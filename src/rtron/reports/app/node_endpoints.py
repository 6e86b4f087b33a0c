"""What each node of a graph of ROS 2 has, without what client libraries add."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from rich.text import Text

from rtron.reports.text_layout import TextPage, counted, heading, paragraph
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Endpoint,
    FunctionType,
    InteractionGraph,
    Node,
    NodeParameter,
    Service,
    ServiceClient,
)


@dataclass(slots=True)
class NodeEndpoints:
    """A node and its sides of topics, services and actions, with its parameters."""

    node: Node
    publishers: list[Endpoint] = field(default_factory=list)
    subscriptions: list[Endpoint] = field(default_factory=list)
    services: list[Service] = field(default_factory=list)
    clients: list[ServiceClient] = field(default_factory=list)
    action_servers: list[Action] = field(default_factory=list)
    action_clients: list[Action] = field(default_factory=list)
    parameters: list[NodeParameter] = field(default_factory=list)

    @property
    def name(self) -> str:
        """The node's full name."""
        return self.node.name

    @property
    def description(self) -> str:
        """What the node runs, empty if that is not known."""
        return "/".join(filter(None, (self.node.package, self.node.executable)))


def endpoints_by_node(graph: InteractionGraph) -> Iterator[NodeEndpoints]:
    """Yield every node of a graph, in its order."""
    nodes = {node.name: NodeEndpoints(node) for node in graph.nodes}
    found: defaultdict[str, NodeEndpoints] = defaultdict(
        lambda: NodeEndpoints(Node(name="")), nodes
    )
    for end in (end for end in graph.endpoints if not end.implicit):
        publishes = end.direction is Direction.PUBLISH
        (found[end.node].publishers if publishes else found[end.node].subscriptions).append(end)
    for service in (service for service in graph.services if not service.implicit):
        found[service.node].services.append(service)
    for client in (client for client in graph.clients if not client.implicit):
        found[client.node].clients.append(client)
    for action in graph.actions:
        serves = action.role is ActionRole.SERVER
        (found[action.node].action_servers if serves else found[action.node].action_clients).append(
            action
        )
    for parameter in graph.parameters:
        found[parameter.node].parameters.append(parameter)
    yield from nodes.values()


MOST_NAMES = 8


def node_functions(nodes: Iterable[Node], page: TextPage) -> Iterator[Text]:
    """Yield a paragraph for each function with its nodes; nothing where no function is known."""
    all_nodes = tuple(nodes)
    known = [node for node in all_nodes if node.function]
    if not known:
        return
    yield from heading("Functions of the nodes")
    for function in FunctionType:
        members = [node for node in known if node.function is function]
        if members:
            text = f"{members[0].domain or function}, {function}: {_names(members)}"
            yield from paragraph(text, page, indent=2)
    unknown = [node for node in all_nodes if not node.function]
    if unknown:
        yield from paragraph(f"not known: {_names(unknown)}", page, indent=2, style="dim")


def _names(nodes: list[Node]) -> str:
    names = [node.name for node in nodes[:MOST_NAMES]]
    left = len(nodes) - MOST_NAMES
    return ", ".join([*names, f"and {counted(left, 'other')}"] if left > 0 else names)

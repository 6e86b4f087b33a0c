"""What each node of a graph of ROS 2 has, without what client libraries add."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Endpoint,
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

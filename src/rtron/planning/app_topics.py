"""Which topics and nodes belong to an action (actionlib's five topics move as one unit)."""

from collections import defaultdict

from rtron.vocabulary import ActionRole, Endpoint, InteractionGraph

PARTS = ("goal", "cancel", "status", "feedback", "result")


def topics_of(graph: InteractionGraph) -> frozenset[str]:
    """Return the topics of a graph, those that only its endpoints name too."""
    listed = (topic.name for topic in graph.topics)
    return frozenset(listed).union(endpoint.topic for endpoint in graph.endpoints)


def action_topics(graph: InteractionGraph) -> frozenset[str]:
    """Return the topics of every action: those the graph names, and those known by their five."""
    found = topics_of(graph)
    spaces: dict[str, int] = defaultdict(int)
    for topic in found:
        space, _, part = topic.rpartition("/")
        spaces[space] += part in PARTS
    named = {action.name for action in graph.actions}
    whole = {space for space, parts in spaces.items() if parts == len(PARTS)}
    return frozenset(f"{space}/{part}" for space in named | whole for part in PARTS) & found


def action_servers(graph: InteractionGraph) -> dict[str, tuple[str, ...]]:
    """Return the nodes that serve actions, each with the names of its actions in order."""
    servers: dict[str, set[str]] = defaultdict(set)
    for action in graph.actions:
        if action.role is ActionRole.SERVER:
            servers[action.node].add(action.name)
    for topic in action_topics(graph):
        if topic.endswith("/result"):
            for endpoint in graph.publishers(topic):
                servers[endpoint.node].add(_space(endpoint))
    return {node: tuple(sorted(names)) for node, names in servers.items()}


def _space(endpoint: Endpoint) -> str:
    return endpoint.topic.rpartition("/")[0]

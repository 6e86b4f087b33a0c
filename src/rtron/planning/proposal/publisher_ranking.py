"""Which publisher goes first until the developer says otherwise.

Your own nodes go before nodes of unknown origin, and these before third parties' nodes: a name
proves nothing, the place of a package does. So what a node that is not yours is called may put it
behind others, never before them. Among equals go first your own emergency stops, then the nodes
that plan or track a path or serve an action, then teleoperation, then those that work from what
they hear, then nodes that only speak, and tools that show things last. What remains equal goes by
what is known of it, then by name.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from rtron.vocabulary import FunctionType, InteractionGraph, Node, Trust

_TRUST = {Trust.OWN: 0, Trust.UNKNOWN: 1, Trust.THIRD_PARTY: 2}
_STOPS, _NAVIGATES, _TELEOPERATES, _WORKS, _SPEAKS, _SHOWS = range(6)
_STOP_NAMES = ("emergency", "estop", "e_stop")
_FUNCTIONS: Mapping[FunctionType | None, int] = {
    FunctionType.PATH_PLANNING: _NAVIGATES,
    FunctionType.GOAL_PLANNER: _NAVIGATES,
    FunctionType.PATH_TRACKING: _NAVIGATES,
    FunctionType.TELEOPERATION: _TELEOPERATES,
    FunctionType.VISUALIZATION: _SHOWS,
}


@dataclass(frozen=True)
class PublisherRanking:
    """Orders nodes of a graph; `servers` and `viewers` are the nodes that serve actions or show."""

    graph: InteractionGraph
    servers: Collection[str]
    viewers: Collection[str]
    nodes: dict[str, Node]

    def sort(self, names: Iterable[str]) -> list[str]:
        """Return the nodes, the one that goes first at the front."""
        return sorted(names, key=self._rank)

    def _rank(self, name: str) -> tuple[int, int, bool, str]:
        node = self.nodes.get(name, Node(name=name))
        is_unknown = node.function not in _FUNCTIONS
        return _TRUST[node.trust], self._function_rank(node), is_unknown, name

    def _function_rank(self, node: Node) -> int:
        observed = self._observed_rank(node)
        function = _FUNCTIONS.get(node.function, observed)
        if node.trust is not Trust.OWN:
            return max(function, observed)
        is_stop = any(word in node.name.lower() for word in _STOP_NAMES)
        return _STOPS if is_stop else function

    def _observed_rank(self, node: Node) -> int:
        if node.name in self.viewers:
            return _SHOWS
        if node.name in self.servers:
            return _NAVIGATES
        subscriptions = (e for e in self.graph.subscribed_by(node.name) if not e.implicit)
        return _WORKS if any(subscriptions) else _SPEAKS

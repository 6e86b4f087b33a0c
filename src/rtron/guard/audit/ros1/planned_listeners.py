"""The subscribers that the audit asks for; strangers may be any number, and do not count."""

from collections.abc import Iterable, Mapping
from itertools import islice

from rtron.guard.audit.common.guard_inputs import matches_any
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph

MAX_MATCHING = 64
"""How many subscribers of a topic count that only match a pattern of the plan."""


class PlannedListeners:
    """Selects the subscribers that the plan expects.

    Whom the plan names always counts. Patterns match any number of names, so of these the first
    ones count.
    """

    def __init__(self, expected: ExpectedGraph) -> None:
        listed = list(expected.listener_patterns())
        self._guard_nodes = expected.guard_nodes
        self._names = frozenset(each for each in listed if "*" not in each)
        self._patterns = tuple(each for each in listed if "*" in each)

    def includes(self, node: str) -> bool:
        """Tell whether the plan expects a node to listen to the guard."""
        return node in self._names or self._matches(node)

    def select(self, subscribers: Mapping[str, Iterable[str]]) -> dict[str, frozenset[str]]:
        """Return the subscribers of each topic that the plan expects, given the oldest first."""
        found = {topic: self._select(nodes) for topic, nodes in subscribers.items()}
        return {topic: nodes for topic, nodes in found.items() if nodes}

    def _select(self, nodes: Iterable[str]) -> frozenset[str]:
        nodes = list(nodes)
        matching = filter(self._matches, nodes) if self._patterns else ()
        return self._names.intersection(nodes).union(islice(matching, MAX_MATCHING))

    def _matches(self, node: str) -> bool:
        return matches_any(self._patterns, node) and node not in self._guard_nodes

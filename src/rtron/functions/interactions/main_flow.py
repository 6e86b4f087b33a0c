"""What of a large graph is worth drawing: what is typical, and where the most of a type flows.

In some hundred packages nearly every function publishes something that every other one subscribes.
A figure of all that shows nothing, so a type read in source is drawn between functions that have
their share of it. The graph as data keeps everything.
"""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from math import ceil

from rtron.functions.interactions.abstract_graph import (
    AbstractGraph,
    Basis,
    DirectInteraction,
    Exchanged,
    typical_types,
)

SHARE = 1 / 3
PACKAGES_A_COUNT = 200
"""In so many packages, one on either side is enough; in twice as many, two."""
_Counts = Mapping[str, Mapping[str, int]]


def main_flow(graph: AbstractGraph) -> AbstractGraph:
    """Return the graph with what is typical, and what many of its packages do."""
    publishers, subscribers = _totals(graph, "source"), _totals(graph, "target")
    least = max(1, ceil(graph.packages / PACKAGES_A_COUNT))

    def is_main(edge: DirectInteraction, message: Exchanged) -> bool:
        if message.type in typical_types(edge.source, edge.target):
            return True
        sent, heard = publishers[message.type], subscribers[message.type]
        few = min(message.publishers, message.subscribers) < least
        return not few and (
            message.publishers >= SHARE * sum(sent.values())
            and message.subscribers >= SHARE * sum(heard.values())
        )

    edges = (
        replace(e, messages=tuple(m for m in e.messages if is_main(e, m))) for e in graph.direct
    )
    return replace(graph, direct=tuple(edge for edge in edges if edge.messages))


def _totals(graph: AbstractGraph, side: str) -> _Counts:
    """Return how many packages of each function have a type on one side, as read in source."""
    found: dict[str, dict[str, int]] = defaultdict(dict)
    for edge in graph.direct:
        for message in edge.messages:
            if message.basis is Basis.SOURCE:
                number = message.publishers if side == "source" else message.subscribers
                found[message.type][edge.source if side == "source" else edge.target] = number
    return found

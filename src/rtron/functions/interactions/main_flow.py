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
    ExchangedMessage,
    typical_types,
)

MIN_SHARE = 1 / 3
PACKAGES_PER_MINIMUM = 200
"""In so many packages, one on either side is enough; in twice as many, two."""
_Counts = Mapping[str, Mapping[str, int]]


def main_flow(graph: AbstractGraph) -> AbstractGraph:
    """Return the graph with what is typical, and what many of its packages do."""
    publishers, subscribers = _package_counts(graph, "source"), _package_counts(graph, "target")
    min_packages = max(1, ceil(graph.packages / PACKAGES_PER_MINIMUM))

    def is_main(edge: DirectInteraction, message: ExchangedMessage) -> bool:
        if message.type in typical_types(edge.source, edge.target):
            return True
        publisher_counts, subscriber_counts = publishers[message.type], subscribers[message.type]
        is_rare = min(message.publishers, message.subscribers) < min_packages
        return not is_rare and (
            message.publishers >= MIN_SHARE * sum(publisher_counts.values())
            and message.subscribers >= MIN_SHARE * sum(subscriber_counts.values())
        )

    edges = (
        replace(e, messages=tuple(m for m in e.messages if is_main(e, m))) for e in graph.direct
    )
    return replace(graph, direct=tuple(edge for edge in edges if edge.messages))


def _package_counts(graph: AbstractGraph, side: str) -> _Counts:
    """Return how many packages of each function have a type on one side, as read in source."""
    counts: dict[str, dict[str, int]] = defaultdict(dict)
    for edge in graph.direct:
        for message in edge.messages:
            if message.basis is Basis.SOURCE:
                number = message.publishers if side == "source" else message.subscribers
                counts[message.type][edge.source if side == "source" else edge.target] = number
    return counts

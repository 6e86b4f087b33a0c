"""A truth that was read in the source by hand, dead entries included, and a graph beside it."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import yaml

from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node, Resolution, Topic, Trust

Triple: TypeAlias = tuple[str, str, str]
"""A node, publish or subscribe, a topic."""

_DIRECTIONS = {"publishes": Direction.PUBLISH, "subscribes": Direction.SUBSCRIBE}
_UNLISTED = ("/rosout", "/parameter_events", "/clock", "/bond")
_UNLISTED_ENDING = "/transition_event"


@dataclass(frozen=True, slots=True, kw_only=True)
class TruthEntry:
    """One line of the truth; `live` is false for what is in the source and never takes place.

    `implicit` marks what a library declares by itself.
    """

    node: str
    direction: Direction
    topic: str
    type: str = ""
    live: bool = True
    implicit: bool = False

    @property
    def triple(self) -> Triple:
        """Return what identifies the entry."""
        return self.node, self.direction.value, self.topic


@dataclass(frozen=True, slots=True, kw_only=True)
class ManualScore:
    """The triples that are live, those that are dead, and those that the graph has."""

    nodes: int
    matched_nodes: int
    live: frozenset[Triple]
    dead: frozenset[Triple]
    reported: frozenset[Triple]

    @property
    def hits(self) -> frozenset[Triple]:
        """Return the live triples that were found."""
        return self.live & self.reported

    @property
    def precision(self) -> float:
        """Return the share of the found triples that are live."""
        return len(self.hits) / len(self.reported) if self.reported else 0.0

    @property
    def recall(self) -> float:
        """Return the share of the live triples that were found."""
        return len(self.hits) / len(self.live) if self.live else 0.0

    def hits_of(self, direction: Direction) -> tuple[int, int]:
        """Return how many live triples of a direction were found, of how many."""
        found, live = (
            sum(triple[1] == direction.value for triple in triples)
            for triples in (self.hits, self.live)
        )
        return found, live

    def differences(self) -> Iterator[str]:
        """Yield a line for each triple that was missed, is dead, or is in no list."""
        extra = self.reported - self.live
        for word, triples in (
            ("MISSED", self.live - self.reported),
            ("DEAD", extra & self.dead),
            ("EXTRA", extra - self.dead),
        ):
            yield from (f"{word:6} {' '.join(triple)}" for triple in sorted(triples))


@dataclass(frozen=True, slots=True)
class ManualTruth:
    """The document of a truth by hand."""

    nodes: tuple[Mapping[str, Any], ...]

    def entries(self, *, first_party: bool = False) -> Iterator[TruthEntry]:
        """Yield every entry, or those of the app's own nodes."""
        for node in self._chosen(first_party=first_party):
            for key, direction in _DIRECTIONS.items():
                for entry in node.get(key) or ():
                    yield TruthEntry(
                        node=node["name"],
                        direction=direction,
                        topic=entry["topic"],
                        type=_type(entry),
                        live=entry.get("live") is not False,
                        implicit=bool(entry.get("implicit")),
                    )

    def score(
        self, graph: InteractionGraph, *, first_party: bool = False, explicit: bool = False
    ) -> ManualScore:
        """Score a graph; only nodes that the truth has count, and no symbolic name.

        `explicit` leaves out what is implicit, in the truth and in the graph.
        """
        names = {node["name"] for node in self._chosen(first_party=first_party)}
        entries = [
            entry
            for entry in self.entries(first_party=first_party)
            if entry.topic != "/bond" and not (explicit and entry.implicit)
        ]
        live = frozenset(entry.triple for entry in entries if entry.live)
        return ManualScore(
            nodes=len(names),
            matched_nodes=len(names & {node.name for node in graph.nodes}),
            live=live,
            dead=frozenset(entry.triple for entry in entries if not entry.live) - live,
            reported=_triples(graph, names, explicit=explicit),
        )

    def graph(self) -> InteractionGraph:
        """Return the graph of the live entries."""
        live = [entry for entry in self.entries() if entry.live]
        types: dict[str, dict[str, None]] = {}
        for entry in live:
            types.setdefault(entry.topic, {})[entry.type] = None
        return InteractionGraph(
            app="truth",
            nodes=tuple(map(_node, self.nodes)),
            topics=tuple(Topic(name=name, types=tuple(found)) for name, found in types.items()),
            endpoints=tuple(
                Endpoint(node=e.node, topic=e.topic, direction=e.direction, type=e.type)
                for e in live
            ),
        )

    def _chosen(self, *, first_party: bool) -> Iterable[Mapping[str, Any]]:
        return [n for n in self.nodes if not (first_party and n.get("third_party"))]


def read_truth(path: Path) -> ManualTruth:
    """Return the truth in a YAML file."""
    return ManualTruth(tuple(yaml.safe_load(path.read_text(encoding="utf-8"))["nodes"]))


def _triples(graph: InteractionGraph, names: set[str], *, explicit: bool) -> frozenset[Triple]:
    return frozenset(
        (end.node, end.direction.value, end.topic)
        for end in graph.endpoints
        if end.node in names
        and end.resolution is not Resolution.SYMBOLIC
        and not end.topic.startswith(_UNLISTED)
        and not end.topic.endswith(_UNLISTED_ENDING)
        and not (explicit and end.implicit)
    )


def _node(node: Mapping[str, Any]) -> Node:
    trust = Trust.THIRD_PARTY if node.get("third_party") else Trust.OWN
    return Node(name=node["name"], package=str(node.get("package") or ""), trust=trust)


def _type(entry: Mapping[str, Any]) -> str:
    found = entry.get("type") or ""
    return str(found[0] if isinstance(found, list) else found)

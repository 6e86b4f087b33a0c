"""What an InteractionGraph is made of, gathered; what is found twice is there once."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from rtron.vocabulary import (
    Action,
    Direction,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    NodeParameter,
    Service,
    ServiceClient,
    Topic,
    UnresolvedCause,
    UnresolvedItem,
    WiringFact,
)


@dataclass(slots=True, kw_only=True)
class GraphBuilder:
    """A graph in the making; an endpoint that is declared twice has all its evidence."""

    ros: int = 1
    nodes: dict[str, Node] = field(default_factory=dict)
    endpoints: dict[tuple[str, str, Direction, str], Endpoint] = field(default_factory=dict)
    services: dict[Service, None] = field(default_factory=dict)
    actions: dict[Action, None] = field(default_factory=dict)
    clients: dict[ServiceClient, None] = field(default_factory=dict)
    parameters: dict[tuple[str, str], NodeParameter] = field(default_factory=dict)
    unresolved: dict[UnresolvedItem, None] = field(default_factory=dict)
    wiring: dict[WiringFact, None] = field(default_factory=dict)

    def add_entity(self, entity: Endpoint | Service | Action | ServiceClient) -> None:
        """Add what a node has."""
        if isinstance(entity, Service):
            self.services[entity] = None
        elif isinstance(entity, Action):
            self.actions[entity] = None
        elif isinstance(entity, ServiceClient):
            self.clients[entity] = None
        else:
            self._add_endpoint(entity)

    def add_unresolved(self, *notes: UnresolvedItem) -> None:
        """Add what could not be found out."""
        self.unresolved.update(dict.fromkeys(notes))

    def add_wiring(self, *facts: WiringFact) -> None:
        """Add what is wired in vain, or in a way that is hardly meant."""
        self.wiring.update(dict.fromkeys(facts))

    def build(self, app: str) -> InteractionGraph:
        """Return the graph of all that was added."""
        endpoints = tuple(self.endpoints.values())
        return InteractionGraph(
            app=app,
            ros=self.ros,
            nodes=tuple(self.nodes.values()),
            topics=tuple(_topics(endpoints)),
            endpoints=endpoints,
            services=tuple(self.services),
            actions=tuple(self.actions),
            clients=tuple(self.clients),
            parameters=tuple(self.parameters.values()),
            unresolved=tuple(_merge_notes(self.unresolved)),
            wiring=tuple(self.wiring),
        )

    def _add_endpoint(self, endpoint: Endpoint) -> None:
        key = (endpoint.node, endpoint.topic, endpoint.direction, endpoint.type)
        first = self.endpoints.get(key)
        if first is not None:
            evidence = tuple(dict.fromkeys((*first.evidence, *endpoint.evidence)))
            implicit = first.implicit and endpoint.implicit
            endpoint = replace(first, evidence=evidence, implicit=implicit)
        self.endpoints[key] = endpoint


def _topics(endpoints: Iterable[Endpoint]) -> Iterator[Topic]:
    types: dict[str, dict[str, None]] = {}
    for endpoint in endpoints:
        types.setdefault(endpoint.topic, {})[endpoint.type] = None
    for name, names_of_types in types.items():
        yield Topic(name=name, types=tuple(filter(None, names_of_types)))


def _merge_notes(notes: Iterable[UnresolvedItem]) -> Iterator[UnresolvedItem]:
    """Yield one note for what is said several times of a file, with all places.

    Of functions that nothing calls one note stands for a file, whichever programs have it.
    """
    merged: dict[tuple[str, ...], UnresolvedItem] = {}
    for note in notes:
        file = note.evidence[0].file if note.evidence else ""
        what = "" if note.cause is UnresolvedCause.UNREACHED else note.what
        key = (what, note.why, note.missing, file)
        first = merged.get(key, note)
        merged[key] = _with_places(first, (*first.evidence, *note.evidence))
    yield from merged.values()


def _with_places(note: UnresolvedItem, places: Iterable[Evidence]) -> UnresolvedItem:
    evidence = tuple(dict.fromkeys(places))
    what, more = note.what.partition(" and ")[0], len(evidence) - 1
    if note.cause is not UnresolvedCause.UNREACHED or not more:
        return replace(note, evidence=evidence)
    return replace(note, what=f"{what} and {more} more", evidence=evidence)

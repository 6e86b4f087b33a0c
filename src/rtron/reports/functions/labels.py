"""What people read in the abstract interaction graph: stages, labels, evidence, the legend."""

from collections.abc import Iterator, Mapping

from rtron.functions.interactions.abstract_graph import (
    AbstractGraph,
    Basis,
    DirectInteraction,
    ExchangedMessage,
    FunctionNode,
)
from rtron.functions.interactions.main_flow import main_flow
from rtron.reports.text_layout import counted
from rtron.sanitize import sanitize
from rtron.vocabulary import Domain, FunctionType

MAX_TYPES = 3
_MAX_LENGTH = 24
STAGES = ("Sensors", "Perception", "Planning", "Control", "Drivers")
ENVIRONMENT = "Environment"
_BASIS_NAMES: Mapping[Basis, str] = {
    Basis.SOURCE: "read in source",
    Basis.MANIFEST: "from manifests",
    Basis.TYPICAL: "assumed",
}
_LEGEND: Mapping[Basis, str] = {
    Basis.SOURCE: "read in source: programs of both functions have the type",
    Basis.MANIFEST: "from manifests: typical of both, and packages of both depend on its package",
    Basis.TYPICAL: "assumed: typical of both functions; nothing says so of these packages",
}


def stage_of(node: FunctionNode) -> str:
    """Return the stage of a function in the picture: sensors come before all others."""
    if node.function is FunctionType.SENSORS:
        return "Sensors"
    return str(node.domain if node.domain is not Domain.OTHERS else Domain.DRIVERS)


def label_lines(edge: DirectInteraction) -> tuple[tuple[str, Basis], ...]:
    """Return the best known types of an edge, each line with how the type is known.

    A long type takes two lines; the last line may say how many types are left.
    """
    lines = [
        (line, message.basis)
        for message in edge.messages[:MAX_TYPES]
        for line in _broken(sanitize(message.type))
    ]
    rest = edge.messages[MAX_TYPES:]
    return (*lines, *((f"and {len(rest)} more", each.basis) for each in rest[:1]))


def evidence_text(message: ExchangedMessage) -> str:
    """Return how it is known that two functions exchange a type."""
    publishers, subscribers = message.sides
    sides = f"{publishers} -> {counted(subscribers, 'package')}"
    if message.basis is Basis.SOURCE:
        return f"read in source, {sides}"
    if message.basis is Basis.MANIFEST:
        return f"from manifests: {sides} may use it"
    return "assumed: typical of both"


def best_basis(edge: DirectInteraction) -> Basis:
    """Return how the best known type of an edge is known: it comes first."""
    return edge.messages[0].basis


def legend(graph: AbstractGraph) -> Iterator[tuple[Basis | None, str]]:
    """Yield a line for each look of arrows in a graph; None is that of the environment's."""
    known = graph.count_by_basis()
    yield from ((basis, text) for basis, text in _LEGEND.items() if known[basis])
    if graph.indirect:
        yield None, "dotted: through the environment"


def notes(graph: AbstractGraph) -> list[str]:
    """Return how much of a graph is known in which way, not drawn, and not read."""
    known = ", ".join(
        f"{_BASIS_NAMES[basis]} {number}" for basis, number in graph.count_by_basis().items()
    )
    found = [f"Message types of all interactions: {known}."]
    hidden = len(graph.direct) - len(main_flow(graph).direct)
    if hidden:
        found.append(
            f"{counted(hidden, 'rarer interaction')} not drawn: a table or JSON has them all."
        )
    if graph.unresolved:
        found.append(f"{counted(len(graph.unresolved), 'thing')} in programs could not be read.")
    if graph.repeated:
        found.append(
            f"{counted(graph.repeated, 'package')} left out: another of the same name counts."
        )
    return found


def _broken(type: str) -> list[str]:
    package, slash, name = type.rpartition("/")
    return [f"{package}{slash}", name] if slash and len(type) > _MAX_LENGTH else [type]

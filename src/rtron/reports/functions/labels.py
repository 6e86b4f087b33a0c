"""How the abstract interaction graph is read by people: stages, labels, evidence."""

from collections.abc import Mapping

from rtron.functions.graph import (
    AbstractGraph,
    Basis,
    DirectInteraction,
    Exchanged,
    FunctionNode,
)
from rtron.functions.main_flow import main_flow
from rtron.reports.sanitize import neutral
from rtron.reports.text_layout import counted
from rtron.vocabulary import Domain, FunctionType

MOST_TYPES = 3
_LONGEST = 24
STAGES = ("Sensors", "Perception", "Planning", "Control", "Drivers")
ENVIRONMENT = "Environment"
BASIS_WORDS: Mapping[Basis, str] = {
    Basis.SOURCE: "read in source",
    Basis.MANIFEST: "from manifests",
    Basis.TYPICAL: "assumed",
}


def stage_of(node: FunctionNode) -> str:
    """Return the part of the picture that a function stands in: sensors stand before all."""
    if node.function is FunctionType.SENSORS:
        return "Sensors"
    return str(node.domain if node.domain is not Domain.OTHERS else Domain.DRIVERS)


def label_lines(edge: DirectInteraction) -> tuple[tuple[str, Basis], ...]:
    """Return the best known types of an edge, each line with how the type is known.

    A long type is on two lines; the last line may say how many are left.
    """
    lines = [
        (line, message.basis)
        for message in edge.messages[:MOST_TYPES]
        for line in _broken(neutral(message.type))
    ]
    left = edge.messages[MOST_TYPES:]
    return (*lines, *((f"and {len(left)} more", each.basis) for each in left[:1]))


def evidence_words(message: Exchanged) -> str:
    """Return how it is known that two functions exchange a type."""
    sent, heard = message.sides
    sides = f"{sent} -> {counted(heard, 'package')}"
    if message.basis is Basis.SOURCE:
        return f"read in source, {sides}"
    if message.basis is Basis.MANIFEST:
        return f"from manifests: {sides} may use it"
    return "assumed: typical of both"


def known_words(graph: AbstractGraph) -> str:
    """Return how many types of all edges are known in which way."""
    known = graph.known()
    parts = ", ".join(f"{BASIS_WORDS[basis]} {number}" for basis, number in known.items())
    return f"Message types of all interactions: {parts}."


def best_basis(edge: DirectInteraction) -> Basis:
    """Return how the best known type of an edge is known: it comes first."""
    return edge.messages[0].basis


def left_out_words(graph: AbstractGraph) -> str:
    """Return how much of a graph its picture leaves out, and why; nothing if it shows all."""
    left = len(graph.direct) - len(main_flow(graph).direct)
    if not left:
        return ""
    return f"{counted(left, 'rarer interaction')} not drawn: a table or JSON has them all."


def unread_words(graph: AbstractGraph) -> str:
    """Return how much could not be found out, or did not count; nothing if all did."""
    parts = []
    if graph.unresolved:
        parts.append(f"{counted(len(graph.unresolved), 'thing')} in programs could not be read.")
    if graph.repeated:
        parts.append(
            f"{counted(graph.repeated, 'package')} left out: another of the same name counts."
        )
    return " ".join(parts)


def _broken(type: str) -> list[str]:
    package, slash, name = type.rpartition("/")
    return [f"{package}{slash}", name] if slash and len(type) > _LONGEST else [type]

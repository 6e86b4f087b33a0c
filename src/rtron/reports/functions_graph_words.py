"""How the abstract interaction graph is read by people: stages, labels, evidence."""

from rtron.functions.graph import (
    AbstractGraph,
    Basis,
    DirectInteraction,
    Exchanged,
    FunctionNode,
)
from rtron.functions.main_flow import main_flow
from rtron.reports.lines import counted
from rtron.reports.neutral import neutral
from rtron.vocabulary import Domain, FunctionType

MOST_TYPES = 3
_LONGEST = 26
STAGES = ("Sensors", "Perception", "Planning", "Control", "Drivers")
ENVIRONMENT = "Environment"


def stage_of(node: FunctionNode) -> str:
    """Return the part of the picture that a function stands in: sensors stand before all."""
    if node.function is FunctionType.SENSORS:
        return "Sensors"
    return str(node.domain if node.domain is not Domain.OTHERS else Domain.DRIVERS)


def label_lines(edge: DirectInteraction) -> tuple[str, ...]:
    """Return the best known types of an edge, a long one on two lines, and how many are left."""
    lines: list[str] = []
    for message in edge.messages[:MOST_TYPES]:
        lines += _broken(neutral(message.type))
    left = len(edge.messages) - MOST_TYPES
    return (*lines, f"and {left} more") if left > 0 else tuple(lines)


def evidence_words(message: Exchanged) -> str:
    """Return how it is known that two functions exchange a type."""
    sides = f"{message.publishers} -> {counted(message.subscribers, 'package')}"
    if message.basis is Basis.SOURCE:
        return f"in source, {sides}"
    return f"typical, may use it: {sides}" if message.basis is Basis.MANIFEST else "typical"


def is_read(edge: DirectInteraction) -> bool:
    """Tell whether a type of an edge was read in source on both sides."""
    return any(message.basis is Basis.SOURCE for message in edge.messages)


def left_out_words(graph: AbstractGraph) -> str:
    """Return how much of a graph its picture leaves out, and why; nothing if it shows all."""
    left = len(graph.direct) - len(main_flow(graph).direct)
    if not left:
        return ""
    return f"{counted(left, 'rarer interaction')} not drawn: a table or JSON has them all."


def _broken(type: str) -> list[str]:
    package, slash, name = type.rpartition("/")
    return [f"{package}{slash}", name] if slash and len(type) > _LONGEST else [type]

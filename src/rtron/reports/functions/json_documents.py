"""The abstract interaction graph as JSON, schema `rtron.functions/1`."""

from dataclasses import asdict
from typing import Any

from rtron.functions.classifier.result import Classification
from rtron.functions.interactions.abstract_graph import (
    FUNCTIONS_SCHEMA,
    AbstractGraph,
    DirectInteraction,
)


def classification_to_json(classification: Classification) -> dict[str, object]:
    """Return a repository's functions, how sure they are, what decided them, and the evidence."""
    return {
        "repo": classification.repo,
        "functions": list(map(str, classification.functions)),
        "primary": str(classification.primary) if classification.primary else None,
        "confidence": _rounded(classification.confidence),
        "probabilities": {
            str(function): _rounded(probability)
            for function, probability in classification.probabilities.items()
        },
        "decided_by": str(classification.decided_by),
        "evidence": [
            {
                "piece": str(each.source),
                "rule": each.rule,
                "type": str(each.type),
                "text": each.text,
                "package": each.package,
            }
            for each in classification.evidence
        ],
    }


def _rounded(probability: float | None) -> float | None:
    return None if probability is None else round(probability, 3)


def functions_to_json(graph: AbstractGraph) -> dict[str, Any]:
    """Return the graph as a JSON document.

    `outside` counts packages of Others or without a known function, `repeated` packages whose name
    another one has, `known` the message types by basis. `from_depends` and `to_depends` of a
    message count packages that depend on the package of its type.
    """
    return {
        "schema": FUNCTIONS_SCHEMA,
        "packages": graph.packages,
        "outside": graph.outside,
        "repeated": graph.repeated,
        "known": {basis.value: number for basis, number in graph.count_by_basis().items()},
        "functions": [
            {
                "name": node.name,
                "function": node.function.value,
                "domain": node.domain.value,
                "packages": node.packages,
            }
            for node in graph.functions
        ],
        "direct": [_direct(edge) for edge in graph.direct],
        "indirect": [
            {"from": edge.source, "to": edge.target, "through": edge.through}
            for edge in graph.indirect
        ],
        "unresolved": [asdict(note) for note in graph.unresolved],
    }


def _direct(edge: DirectInteraction) -> dict[str, Any]:
    messages = [asdict(message) | {"basis": message.basis.value} for message in edge.messages]
    return {"from": edge.source, "to": edge.target, "messages": messages}

"""Evidence as people read it: files named from the folder that was scanned."""

from dataclasses import replace
from pathlib import Path

from rtron.vocabulary import Endpoint, Evidence, InteractionGraph, UnresolvedItem


def with_relative_evidence(graph: InteractionGraph, root: Path | None) -> InteractionGraph:
    """Return a graph whose evidence below `root` is named from there."""
    if root is None:
        return graph
    prefix = f"{root}/"
    endpoints = (_relative_endpoint(endpoint, prefix) for endpoint in graph.endpoints)
    unresolved = (_relative_note(note, prefix) for note in graph.unresolved)
    return replace(graph, endpoints=tuple(endpoints), unresolved=tuple(unresolved))


def _relative_endpoint(endpoint: Endpoint, prefix: str) -> Endpoint:
    return replace(endpoint, evidence=_relative_to(endpoint.evidence, prefix))


def _relative_note(note: UnresolvedItem, prefix: str) -> UnresolvedItem:
    return replace(note, evidence=_relative_to(note.evidence, prefix))


def _relative_to(evidence: tuple[Evidence, ...], prefix: str) -> tuple[Evidence, ...]:
    return tuple(replace(each, file=each.file.removeprefix(prefix)) for each in evidence)

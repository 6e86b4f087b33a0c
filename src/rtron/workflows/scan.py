"""Evidence as people read it: files named from the folder that was scanned."""

from dataclasses import replace
from pathlib import Path

from rtron.vocabulary import Endpoint, Evidence, InteractionGraph, Unresolved


def from_root(graph: InteractionGraph, root: Path | None) -> InteractionGraph:
    """Return a graph whose evidence below `root` is named from there."""
    if root is None:
        return graph
    prefix = f"{root}/"
    endpoints = (_shortened(endpoint, prefix) for endpoint in graph.endpoints)
    unresolved = (_shortened_note(note, prefix) for note in graph.unresolved)
    return replace(graph, endpoints=tuple(endpoints), unresolved=tuple(unresolved))


def _shortened(endpoint: Endpoint, prefix: str) -> Endpoint:
    return replace(endpoint, evidence=_named(endpoint.evidence, prefix))


def _shortened_note(note: Unresolved, prefix: str) -> Unresolved:
    return replace(note, evidence=_named(note.evidence, prefix))


def _named(evidence: tuple[Evidence, ...], prefix: str) -> tuple[Evidence, ...]:
    return tuple(replace(each, file=each.file.removeprefix(prefix)) for each in evidence)

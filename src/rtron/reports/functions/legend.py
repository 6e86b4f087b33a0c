"""What explains the picture of the functions' interaction graph, below it."""

from collections.abc import Iterator, Mapping

from rtron.functions.graph import AbstractGraph, Basis
from rtron.reports.functions.labels import known_words, left_out_words, unread_words

LOOKS: Mapping[Basis, tuple[str, float]] = {
    Basis.SOURCE: ("#1b1b1b", 2.2),
    Basis.MANIFEST: ("#5f6b76", 1.5),
    Basis.TYPICAL: ("#a3abb3", 1.1),
}
"""The colour and width of arrows, by how the best known of their types is known."""
WORDS: Mapping[Basis, str] = {
    Basis.SOURCE: 'fill="#0b2239" font-weight="bold"',
    Basis.MANIFEST: 'fill="#33475b"',
    Basis.TYPICAL: 'fill="#66717c" font-style="italic"',
}
"""How the types on arrows are written, by how they are known."""
_EXPLAINED: Mapping[Basis, str] = {
    Basis.SOURCE: "read in source: programs of both functions have the type",
    Basis.MANIFEST: "from manifests: typical of both, and packages of both depend on its package",
    Basis.TYPICAL: "assumed: typical of both functions; nothing says so of these packages",
}
_THROUGH = "dotted: through the environment, a lane for each thing that changes"


def legend_lines(graph: AbstractGraph) -> Iterator[tuple[Basis | None, str]]:
    """Yield the lines of the legend of a graph, with the look that each explains.

    None is that of arrows through the environment, or of none at all: such a line has no sample.
    """
    known = graph.known()
    yield from ((basis, text) for basis, text in _EXPLAINED.items() if known[basis])
    if graph.indirect:
        yield None, _THROUGH


def notes(graph: AbstractGraph) -> list[str]:
    """Return what is to be told of a graph beside its picture."""
    return [*filter(None, (known_words(graph), left_out_words(graph), unread_words(graph)))]

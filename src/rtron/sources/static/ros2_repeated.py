"""Nodes that one line of a launch starts more than once, as where two files include a third."""

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator

from rtron.sources.static.node import AppNode
from rtron.vocabulary import Unresolved


def repeated(nodes: Iterable[AppNode]) -> Iterator[Unresolved]:
    """Yield a note for each node that certainly starts more than once."""
    alike: dict[Hashable, list[AppNode]] = defaultdict(list)
    for node in nodes:
        if not node.doubtful and "{" not in node.name:
            alike[_identity(node)].append(node)
    for first, *others in alike.values():
        if others:
            why = f"started {len(others) + 1} times; they all run, and nothing tells them apart"
            yield Unresolved(what=f"node {first.name}", why=why, evidence=(first.evidence,))


def _identity(node: AppNode) -> Hashable:
    """Return what is alike; a node that is not named may take its name from its arguments."""
    return node.name, node.evidence, () if node.site.named else node.site.args

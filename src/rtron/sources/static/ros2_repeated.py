"""Nodes that one line of a launch starts more than once, as where two files include a third."""

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator

from rtron.sources.static.common.node_part import Part
from rtron.vocabulary import Unresolved


def repeated(parts: Iterable[Part]) -> Iterator[Unresolved]:
    """Yield a note for each node that certainly starts more than once."""
    alike: dict[Hashable, list[Part]] = defaultdict(list)
    for part in parts:
        if not part.node.doubtful and "{" not in _name(part):
            alike[_identity(part)].append(part)
    for first, *others in alike.values():
        if others:
            why = f"started {len(others) + 1} times; they all run, and nothing tells them apart"
            place = first.node.evidence
            yield Unresolved(what=f"node {_name(first)}", why=why, evidence=(place,))


def _name(part: Part) -> str:
    """Return what a node calls itself, or is called by the launch."""
    return next((made.name for made in part.interface.nodes), part.node.name)


def _identity(part: Part) -> Hashable:
    """Return what is alike; a node that is not named may take its name from its arguments."""
    node, site = part.node, part.node.site
    return _name(part), node.evidence, node.rules, () if site.named else site.args

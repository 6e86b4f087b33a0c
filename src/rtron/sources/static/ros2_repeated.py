"""Nodes that one line of a launch starts more than once, as where two files include a third."""

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator

from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import UnresolvedItem


def duplicate_nodes(parts: Iterable[NodePart]) -> Iterator[UnresolvedItem]:
    """Yield a note for each node that certainly starts more than once."""
    parts_by_identity: dict[Hashable, list[NodePart]] = defaultdict(list)
    for part in parts:
        if not part.node.is_uncertain and "{" not in _node_name(part):
            parts_by_identity[_node_identity(part)].append(part)
    for first, *others in parts_by_identity.values():
        if others:
            why = f"started {len(others) + 1} times; they all run, and nothing tells them apart"
            location = first.node.evidence
            yield UnresolvedItem(what=f"node {_node_name(first)}", why=why, evidence=(location,))


def _node_name(part: NodePart) -> str:
    """Return what a node calls itself, or is called by the launch."""
    return next((created.name for created in part.interface.nodes), part.node.name)


def _node_identity(part: NodePart) -> Hashable:
    """Return what is alike; a node that is not named may take its name from its arguments."""
    node, site = part.node, part.node.site
    return (
        _node_name(part),
        node.evidence,
        node.process_remap_rules,
        () if site.has_launch_name else site.args,
    )

"""Nodes whose names the launch file does not tell: rules that begin with a node's name reach them.

A rule's prefix is a node's name without its namespace (docs.ros.org: node arguments).
"""

from collections.abc import Collection, Mapping
from dataclasses import replace

from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.remaps import Wiring, wire
from rtron.vocabulary import LaunchFile, LaunchNode, LaunchTree, Stream, names_node
from rtron.vocabulary.remap_rules import UNKNOWN, remaps_at


def unnamed(node: LaunchNode) -> bool:
    """Tell whether a node's name or namespace is known only to the running launch."""
    space, _, base = node.name.rpartition("/")
    return UNKNOWN in {base, space}


def absent(planned: Collection[str], tree: LaunchTree) -> tuple[str, ...]:
    """Return the names of a plan that no launched node has."""
    names = [node.name for node in tree.nodes() if not unnamed(node)]
    return tuple(name for name in planned if not any(names_node(name, own) for own in names))


def wire_unnamed(tree: LaunchTree, enforced: tuple[Stream, ...], names: Collection[str]) -> Wiring:
    """Return the rules for nodes that may be one of several, by name."""
    return {
        node: rules
        for node in tree.nodes()
        if unnamed(node) and (rules := _rules(node, enforced, names))
    }


def _rules(
    node: LaunchNode, enforced: tuple[Stream, ...], names: Collection[str]
) -> tuple[PlacedRemap, ...]:
    found: dict[str, list[PlacedRemap]] = {}
    for name in filter(lambda name: _may_be(node, name), names):
        base = name.rpartition("/")[2]
        for placed in _wired(_as(node, name), enforced):
            written = f"{base}:{placed.written}"
            found.setdefault(written, []).append(replace(placed, written=written))
    return tuple(same[0] for same in found.values() if len({one.target for one in same}) == 1)


def _may_be(node: LaunchNode, name: str) -> bool:
    if UNKNOWN in name:
        return False
    space, _, base = node.name.rpartition("/")
    inside = space == UNKNOWN or name.startswith(f"{space}/")
    return inside and base in {UNKNOWN, name.rpartition("/")[2]}


def _as(node: LaunchNode, name: str) -> LaunchNode:
    """Return the node as it is under a name."""
    rules = ((remap.written, remap.written_target) for remap in node.remaps)
    return replace(node, name=name, remaps=tuple(remaps_at(rules, name)))


def _wired(node: LaunchNode, enforced: tuple[Stream, ...]) -> tuple[PlacedRemap, ...]:
    tree = LaunchTree(root=LaunchFile(path="", nodes=(node,)))
    wired: Mapping[LaunchNode, tuple[PlacedRemap, ...]] = wire(tree, enforced)
    return wired.get(node, ())

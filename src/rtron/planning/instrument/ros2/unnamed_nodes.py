"""Nodes whose names the launch file does not tell: rules that begin with a node's name reach them.

A rule's prefix is a node's name without its namespace (docs.ros.org: node arguments).
"""

from collections.abc import Collection, Mapping
from dataclasses import replace

from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.remaps import NodeRemaps, plan_remaps
from rtron.vocabulary import LaunchFile, LaunchNode, LaunchTree, Stream, matches_node
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, remaps_for_node


def is_unnamed(node: LaunchNode) -> bool:
    """Tell whether a node's name or namespace is known only to the running launch."""
    namespace, _, base = node.name.rpartition("/")
    return UNKNOWN_NAME in {base, namespace}


def missing_nodes(planned: Collection[str], tree: LaunchTree) -> tuple[str, ...]:
    """Return the names of a plan that no launched node has."""
    names = [node.name for node in tree.nodes() if not is_unnamed(node)]
    return tuple(
        name for name in planned if not any(matches_node(name, launched) for launched in names)
    )


def plan_unnamed_remaps(
    tree: LaunchTree, enforced: tuple[Stream, ...], names: Collection[str]
) -> NodeRemaps:
    """Return the rules for nodes that may be one of several, by name."""
    return {
        node: rules
        for node in tree.nodes()
        if is_unnamed(node) and (rules := _rules(node, enforced, names))
    }


def _rules(
    node: LaunchNode, enforced: tuple[Stream, ...], names: Collection[str]
) -> tuple[PlacedRemap, ...]:
    found: dict[str, list[PlacedRemap]] = {}
    for name in filter(lambda name: _may_have_name(node, name), names):
        base = name.rpartition("/")[2]
        for placed in _remaps_for(_with_name(node, name), enforced):
            written = f"{base}:{placed.written}"
            found.setdefault(written, []).append(replace(placed, written=written))
    return tuple(same[0] for same in found.values() if len({one.target for one in same}) == 1)


def _may_have_name(node: LaunchNode, name: str) -> bool:
    if UNKNOWN_NAME in name:
        return False
    namespace, _, base = node.name.rpartition("/")
    inside = namespace == UNKNOWN_NAME or name.startswith(f"{namespace}/")
    return inside and base in {UNKNOWN_NAME, name.rpartition("/")[2]}


def _with_name(node: LaunchNode, name: str) -> LaunchNode:
    """Return the node as it is under a name."""
    rules = ((remap.written_source, remap.written_target) for remap in node.remaps)
    return replace(node, name=name, remaps=tuple(remaps_for_node(rules, name)))


def _remaps_for(node: LaunchNode, enforced: tuple[Stream, ...]) -> tuple[PlacedRemap, ...]:
    tree = LaunchTree(root=LaunchFile(path="", nodes=(node,)))
    remaps: Mapping[LaunchNode, tuple[PlacedRemap, ...]] = plan_remaps(tree, enforced)
    return remaps.get(node, ())

"""Launch files that the app's nodes start themselves, and which of those nodes must be led."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.vocabulary import Evidence, LaunchInclude, LaunchTree


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeLaunchTree:
    """A launch file that a node starts, evaluated for the arguments that the node gives.

    `starter` is the node's full name, `evidence` the places in its program.
    """

    tree: LaunchTree
    starter: str
    evidence: tuple[Evidence, ...] = ()

    @property
    def path(self) -> Path:
        """The launch file."""
        return Path(self.tree.root.path)


def merge_launches(tree: LaunchTree, started: Iterable[RuntimeLaunchTree]) -> LaunchTree:
    """Return one tree that has all nodes of a launch and of those that its nodes start."""
    trees = [launch.tree for launch in started]
    added = [LaunchInclude(element_index=0, evaluated_name=t.root.path, file=t.root) for t in trees]
    root = replace(tree.root, includes=(*tree.root.includes, *added))
    unresolved = (note for launch in (tree, *trees) for note in launch.unresolved)
    return replace(tree, root=root, unresolved=tuple(dict.fromkeys(unresolved)))


def starter_nodes(started: Sequence[RuntimeLaunchTree], remaps: NodeRemaps) -> frozenset[str]:
    """Return the nodes that start a launch file which changes, by remaps or by a starter in it."""
    found: set[str] = set()
    for _ in started:
        found |= {
            one.starter
            for one in started
            if any(remaps.get(node) or node.name in found for node in one.tree.nodes())
        }
    return frozenset(found)

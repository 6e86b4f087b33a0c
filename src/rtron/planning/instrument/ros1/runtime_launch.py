"""Launch files that the app's nodes start themselves, and which of those nodes must be led."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.planning.instrument.common.remaps import Wiring
from rtron.vocabulary import Evidence, LaunchInclude, LaunchTree


@dataclass(frozen=True, slots=True, kw_only=True)
class Started:
    """A launch file that a node starts, evaluated for the arguments that the node gives.

    `by` is the node's full name, `evidence` the places in its program.
    """

    tree: LaunchTree
    by: str
    evidence: tuple[Evidence, ...] = ()

    @property
    def path(self) -> Path:
        """The launch file."""
        return Path(self.tree.root.path)


def whole_app(tree: LaunchTree, started: Iterable[Started]) -> LaunchTree:
    """Return one tree that has all nodes of a launch and of those that its nodes start."""
    trees = [one.tree for one in started]
    added = [LaunchInclude(element=0, spelled=t.root.path, file=t.root) for t in trees]
    root = replace(tree.root, includes=(*tree.root.includes, *added))
    unresolved = (note for one in (tree, *trees) for note in one.unresolved)
    return replace(tree, root=root, unresolved=tuple(dict.fromkeys(unresolved)))


def starters(started: Sequence[Started], wiring: Wiring) -> frozenset[str]:
    """Return the nodes that start a launch file which changes, by remaps or by a starter in it."""
    found: set[str] = set()
    for _ in started:
        found |= {
            one.by
            for one in started
            if any(wiring.get(node) or node.name in found for node in one.tree.nodes())
        }
    return frozenset(found)

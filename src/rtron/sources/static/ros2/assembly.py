"""Puts the parts of an app of ROS 2 together to its InteractionGraph.

A process may have several nodes, each with its own remap rules; a component is a node of its own.
"""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from rtron.sources.declaration import Declaration, MadeNode
from rtron.sources.static.common.graph_builder import GraphParts
from rtron.sources.static.common.node_part import Part
from rtron.sources.static.ros2.endpoints import Rules, joined
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, Node, Unresolved


@dataclass(slots=True, kw_only=True)
class Ros2Assembly(GraphParts):
    """A graph in the making; nodes of one name stay apart in ROS 2, here they are one."""

    workspace: Workspace
    ros: int = 2
    _started: dict[str, Evidence] = field(default_factory=dict)

    def add(self, part: Part) -> None:
        """Add the nodes of a process or component, and what they declare."""
        declared: dict[str, list[Declaration]] = defaultdict(list)
        for one in part.interface.declarations:
            declared[one.node or part.node.name].append(one)
        for made in _made(part):
            self._add_node(made.name, part)
            rules = (*made.remaps, *(part.node.rules if made.globally else ()))
            for found in joined(made.name, declared[made.name], Rules(rules, made.name)):
                self.put(found)
        for parameter in part.interface.parameters:
            self.parameters[parameter.node, parameter.name] = parameter
        self.note(*part.interface.unresolved)
        self.note(*_unseen(part))
        for started in part.interface.starts:
            what = f"launch {started.path} that {part.owner} starts"
            why = "what a node starts itself is not followed: name it with --launch too"
            self.note(Unresolved(what=what, why=why, evidence=started.evidence))

    def _add_node(self, name: str, part: Part) -> None:
        node = part.node
        first = self._started.setdefault(name, node.evidence)
        if name not in self.nodes:
            self.nodes[name] = Node(
                name=name,
                package=node.package,
                executable=node.type,
                origin=node.origin,
                trust=self.workspace.trust(node.package),
            )
        elif "{" not in name and first != node.evidence:
            why = "started at several places; they all run, and nothing tells them apart"
            places = (first, node.evidence)
            self.note(Unresolved(what=f"node {name}", why=why, evidence=places))


def _unseen(part: Part) -> Iterator[Unresolved]:
    """Yield a note on a program whose source is here and makes no node: code elsewhere may."""
    node, found = part.node, part.interface
    if part.task is not None and not (found.declarations or found.nodes):
        what = f"node {node.name} ({node.package}/{node.type})"
        why = "its source is here, and no node is seen that it makes"
        yield Unresolved(what=what, why=why, evidence=(node.evidence,))


def _made(part: Part) -> Iterator[MadeNode]:
    """Yield the nodes of a process; where its source tells of none, that which the launch names."""
    names = {made.name for made in part.interface.nodes}
    yield from part.interface.nodes
    others = dict.fromkeys(d.node or part.node.name for d in part.interface.declarations)
    for name in others if names else (others or {part.node.name: None}):
        if name not in names:
            yield MadeNode(name=name)

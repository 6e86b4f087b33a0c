"""Puts the parts of an app together to its InteractionGraph."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from rtron.sources.declaration import NodeInterface
from rtron.sources.static.common.app_node import AppNode
from rtron.sources.static.common.endpoints import (
    Remapping,
    action_of,
    clock_of,
    endpoints_of,
    service_of,
)
from rtron.sources.static.common.graph_builder import GraphParts
from rtron.sources.static.common.node_part import Part
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Node, Parameters, Unresolved

_SIM_TIME = "/use_sim_time"


@dataclass(slots=True, kw_only=True)
class Assembly(GraphParts):
    """A graph in the making; what is declared twice is there once, with all its evidence."""

    workspace: Workspace
    started: dict[str, AppNode] = field(default_factory=dict)

    def add_node(self, node: AppNode) -> None:
        """Add a node; another one of its name takes its place in ROS, and is noted here."""
        first = self.started.setdefault(node.name, node)
        if first is node:
            self.nodes[node.name] = Node(
                name=node.name,
                package=node.package,
                executable=node.type,
                origin=node.origin,
                trust=self.workspace.trust(node.package),
            )
        elif "*" not in node.name and first.evidence != node.evidence:
            places = (first.evidence, node.evidence)
            why = "started at several places; the last that starts ends the others"
            self.note(Unresolved(what=f"node {node.name}", why=why, evidence=places))

    def add(self, part: Part) -> None:
        """Add what a part declares to the node whose process it runs in."""
        owner = self.started.get(part.owner)
        if owner is None:
            self.nodes.setdefault(part.owner, Node(name=part.owner))
            why = "no launch file that is read starts it"
            self.note(
                Unresolved(what=f"node {part.owner}", why=why, evidence=(part.node.evidence,))
            )
        outer = dict(owner.site.remaps) if owner else {}
        self._declare(
            part.owner, part.interface, Remapping({**outer, **dict(part.node.site.remaps)})
        )

    def add_clock(self, parts: Iterable[Part], parameters: Parameters) -> None:
        """Let every node that is one of ROS follow simulated time, where that is set."""
        found = parameters.get(_SIM_TIME)
        if found is None or found.value is not True:
            return
        for part in parts:
            if part.task is not None or part.interface.declarations:
                self.put(clock_of(part.node.name, found.evidence))

    def _declare(self, node: str, interface: NodeInterface, remap: Remapping) -> None:
        for declared in interface.declarations:
            for endpoint in endpoints_of(node, declared, remap):
                self.put(endpoint)
            self.services.update(dict.fromkeys(service_of(node, declared, remap)))
            self.actions.update(dict.fromkeys(action_of(node, declared, remap)))
        self.note(*interface.unresolved)

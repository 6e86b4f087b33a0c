"""Puts the parts of an app together to its InteractionGraph."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from rtron.sources.static.common.app_node import AppNode, may_both_start
from rtron.sources.static.common.devices import firmware, last_messages, message_flows
from rtron.sources.static.common.endpoints import (
    ProcessRemaps,
    clock_subscription,
    declared_action,
    declared_endpoints,
    declared_service_sides,
)
from rtron.sources.static.common.frames import FrameBroadcasters
from rtron.sources.static.common.graph_builder import GraphBuilder
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.task import TaskKind
from rtron.sources.static.common.topic_parameters import unused_topic_parameters
from rtron.sources.static.common.wiring import ProgramOutputs, RemapUses, sent_once
from rtron.sources.static.ros1.node_parameters import node_parameters
from rtron.sources.workspace import ProgramLanguage, Workspace
from rtron.vocabulary import (
    Direction,
    LaunchTree,
    Node,
    ParameterTree,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.names import TRANSFORMS

_SIM_TIME = "/use_sim_time"


@dataclass(slots=True, kw_only=True)
class Assembly(GraphBuilder):
    """A graph in the making; what is declared twice is there once, with all its evidence."""

    workspace: Workspace
    started_nodes: dict[str, AppNode] = field(default_factory=dict)
    remap_uses: RemapUses = field(default_factory=RemapUses)
    program_outputs: ProgramOutputs = field(default_factory=ProgramOutputs)
    frames: FrameBroadcasters = field(default_factory=lambda: FrameBroadcasters(ros=1))

    def add_node(self, node: AppNode) -> None:
        """Add a node; another one of its name takes its place in ROS, and is noted here."""
        first = self.started_nodes.setdefault(node.name, node)
        if first is node:
            self.nodes[node.name] = Node(
                name=node.name,
                package=node.package,
                executable=node.type,
                origin=node.origin,
                trust=self.workspace.trust(node.package),
            )
        elif self._is_second(first, node):
            self.add_wiring(
                WiringFact(
                    kind=WiringFactKind.DUPLICATE_NODE,
                    subject=node.name,
                    others=(first.program, node.program),
                    evidence=(first.evidence, node.evidence),
                )
            )

    def _is_second(self, first: AppNode, node: AppNode) -> bool:
        """Return whether a node takes the name of another; a shell script has none of its own."""
        programs = (self.workspace.executable(n.package, n.type) for n in (first, node))
        is_shell = any(p is not None and p.language is ProgramLanguage.SHELL for p in programs)
        return not is_shell and "*" not in node.name and may_both_start(first, node)

    def add_part(self, part: NodePart) -> None:
        """Add what a part declares to the node whose process it runs in."""
        owner = self.started_nodes.get(part.owner)
        if owner is None:
            self.nodes.setdefault(part.owner, Node(name=part.owner))
            why = "no launch file that is read starts it"
            self.add_unresolved(
                UnresolvedItem(what=f"node {part.owner}", why=why, evidence=(part.node.evidence,))
            )
        if part.is_unread:
            self.nodes[part.owner] = replace(self.nodes[part.owner], unread=True)
        process_remaps = dict(owner.site.remaps) if owner else {}
        remaps = {**process_remaps, **dict(part.node.site.remaps)}
        is_python = part.task is not None and part.task.kind is TaskKind.PYTHON
        self._declare(part, ProcessRemaps(remaps, is_roscpp=not is_python))
        self.add_wiring(*firmware(part), *last_messages(part), *message_flows(part))
        self.add_wiring(*sent_once(part))
        self.frames.add(part, remaps.get(TRANSFORMS, TRANSFORMS))
        self.remap_uses.add(part, part.owner, remaps, _declared_names(part))

    def add_wiring_facts(self, trees: Iterable[LaunchTree], parameters: ParameterTree) -> None:
        """Note the remaps that change no name of the app, and outputs and frames in common."""
        for tree in trees:
            for remap in tree.remaps_behind_all:
                self.remap_uses.add_behind_all(remap)
            self.add_wiring(*tree.wiring)
        self.add_wiring(*self.remap_uses.idle(self.endpoints.values(), parameters.leaves))
        self.add_wiring(*self.remap_uses.unread())
        self.add_wiring(*self.program_outputs.second_sources())
        self.add_wiring(*self.program_outputs.shared())
        self.add_wiring(*self.frames.facts(), *self.frames.loops())
        self.add_wiring(*self.frames.stray_frames(), *self.frames.missing_frames())

    def add_clock(self, parts: Iterable[NodePart], parameters: ParameterTree) -> None:
        """Let every node that is one of ROS follow simulated time, where that is set."""
        parameter = parameters.get(_SIM_TIME)
        if parameter is None or parameter.value is not True:
            return
        for part in parts:
            if part.task is not None or part.interface.declarations:
                self.add_entity(clock_subscription(part.node.name, parameter.evidence))

    def add_parameters(self, parameters: ParameterTree) -> None:
        """Add what the launch sets for nodes, and note what of it names topics nobody uses."""
        for parameter in node_parameters(parameters, self.nodes):
            self.parameters[parameter.node, parameter.name] = parameter
        leaves = ((name, leaf.value, leaf.evidence) for name, leaf in parameters.leaves.items())
        topics = {end.topic for end in self.endpoints.values()} | self.remap_uses.sources
        self.add_wiring(*unused_topic_parameters(leaves, topics))

    def _declare(self, part: NodePart, remap: ProcessRemaps) -> None:
        node, interface = part.owner, part.interface
        for declared in interface.declarations:
            for endpoint in declared_endpoints(node, declared, remap):
                self.add_entity(endpoint)
                if endpoint.direction is Direction.PUBLISH and not endpoint.implicit:
                    self.program_outputs.add(part, endpoint)
            for service_side in declared_service_sides(node, declared, remap):
                self.add_entity(service_side)
            self.actions.update(dict.fromkeys(declared_action(node, declared, remap)))
        self.add_unresolved(*interface.unresolved)


def _declared_names(part: NodePart) -> frozenset[str]:
    """Return the names that remaps can change: of topics, services, and actions of roscpp."""
    remap = ProcessRemaps({})
    declared = part.interface.declarations
    topics = (end for each in declared for end in declared_endpoints("", each, remap))
    return frozenset((*(each.name for each in declared), *(end.topic for end in topics)))

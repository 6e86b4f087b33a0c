"""Puts the parts of an app together to its InteractionGraph, with the parameters of each node."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace
from math import isfinite

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
from rtron.sources.static.common.topic_parameters import (
    near_parameters,
    unread_parameter,
    unused_topic_parameters,
)
from rtron.sources.static.common.wiring import ProgramOutputs, RemapUses, sent_once
from rtron.sources.workspace import ProgramLanguage, Workspace
from rtron.vocabulary import (
    Direction,
    LaunchTree,
    Node,
    NodeParameter,
    NodeParameterValue,
    ParameterTree,
    ParameterValue,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.names import TRANSFORMS

_OF_CONTROLLERS = "cmd_vel_timeout"
"""Controllers of ros_control are no nodes, their parameters stand below their own names."""
_RECONFIGURED = "/parameter_descriptions"
"""What dynamic_reconfigure's server publishes, which reads the parameters of a .cfg file."""
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


def node_parameters(parameters: ParameterTree, nodes: Collection[str]) -> Iterator[NodeParameter]:
    """Yield the parameters of nodes, as `group.name`, and the timeouts of controllers."""
    for full_name, leaf in parameters.leaves.items():
        owner = next(filter(nodes.__contains__, _namespaces(full_name)), "")
        if not owner and full_name.endswith(f"/{_OF_CONTROLLERS}"):
            owner = full_name.rpartition("/")[0]
        if owner:
            name = full_name.removeprefix(f"{owner}/").replace("/", ".")
            yield NodeParameter(node=owner, name=name, value=_plain(leaf.value))
            for key, value in _items(leaf.value):
                yield NodeParameter(node=owner, name=f"{name}.{key}", value=_plain(value))


def _items(value: ParameterValue) -> Iterator[tuple[str, ParameterValue]]:
    """Yield what stands in the maps of a list, as `NUMBER.KEY`: the inputs of a twist_mux."""
    for number, item in enumerate(value if isinstance(value, list) else ()):
        for key, inner in item.items() if isinstance(item, dict) else ():
            yield f"{number}.{key}", inner


def _namespaces(name: str) -> Iterator[str]:
    """Yield what a name lies in, the nearest first."""
    while name := name.rpartition("/")[0]:
        yield name


def _plain(value: ParameterValue) -> NodeParameterValue | None:
    """Return a value that a node of ROS 2 may have too, None for another."""
    if isinstance(value, list):
        items = [None if isinstance(item, list) else _plain(item) for item in value]
        found = tuple(item for item in items if isinstance(item, (bool, int, float, str)))
        return found if len(found) == len(value) else None
    is_endless = isinstance(value, float) and not isfinite(value)
    return value if isinstance(value, (bool, int, float, str)) and not is_endless else None


def unread_parameters(parts: Iterable[NodePart], parameters: ParameterTree) -> Iterator[WiringFact]:
    """Yield a fact for each private parameter that its node does not read, with the near name.

    A near name is one that the node reads and nobody sets. A node counts if its source was read
    whole and reads private parameters, all with known names. A file is often given to several
    nodes: a parameter that another node reads of its own, or of this one, does not count.
    """
    parts_by_node: dict[str, list[NodePart]] = defaultdict(list)
    for part in parts:
        parts_by_node[part.node.name].append(part)
    read = {node: _read_names(of_node) for node, of_node in parts_by_node.items()}
    read_by_any = set().union(*read.values())
    private = set().union(*(_below(node, names) for node, names in read.items()))
    set_for = _set_for(parts_by_node, parameters)
    for node, of_node in parts_by_node.items():
        own, given = _below(node, read[node]), set_for[node]
        if own and all(map(_is_read_whole, of_node)) and "{" not in "".join(read[node]):
            others = (name for name in given if not _is_read(f"{node}/{name}", read_by_any))
            unread = [name for name in others if name not in private]
            near = near_parameters(unread, own - given)
            for name in sorted(unread):
                place = parameters.leaves[f"{node}/{name}"].evidence
                yield unread_parameter(node, name, near.get(name), place)


def _set_for(nodes: Collection[str], parameters: ParameterTree) -> dict[str, set[str]]:
    """Return the names below each node that the launch sets."""
    found: dict[str, set[str]] = defaultdict(set)
    for leaf in parameters.leaves:
        for owner in filter(nodes.__contains__, _namespaces(leaf)):
            found[owner].add(leaf.removeprefix(f"{owner}/"))
    return found


def _read_names(parts: Iterable[NodePart]) -> set[str]:
    return {parameter.name for part in parts for parameter in part.interface.parameters}


def _is_read_whole(part: NodePart) -> bool:
    interface = part.interface
    is_reconfigured = any(each.name.endswith(_RECONFIGURED) for each in interface.declarations)
    return bool(part.task and not part.model and not interface.unresolved and not is_reconfigured)


def _below(node: str, names: Iterable[str]) -> set[str]:
    return {name.removeprefix(f"{node}/") for name in names if name.startswith(f"{node}/")}


def _is_read(name: str, read: set[str]) -> bool:
    """Return whether a parameter is read, or the group it is in, or one below it."""
    parts = name.split("/")
    groups = {"/".join(parts[:count]) for count in range(2, len(parts) + 1)}
    return not groups.isdisjoint(read)

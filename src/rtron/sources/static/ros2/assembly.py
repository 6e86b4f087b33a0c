"""Puts the parts of an app of ROS 2 together to its InteractionGraph.

A process may have several nodes, each with its own remap rules; a component is a node of its own.
"""

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice

from rtron.sources.declaration import CreatedNode, Declaration, GazeboTopic
from rtron.sources.static.common.app_node import AppNode, may_both_start
from rtron.sources.static.common.devices import firmware, last_messages, message_flows
from rtron.sources.static.common.frames import FrameBroadcasters, node_name
from rtron.sources.static.common.graph_builder import GraphBuilder
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.task import TaskKind
from rtron.sources.static.common.topic_parameters import unused_topic_parameters
from rtron.sources.static.common.wiring import ProgramOutputs, RemapUses, sent_once
from rtron.sources.static.ros2.endpoints import RemapRules, graph_entities, parameter_value
from rtron.sources.static.ros2.gazebo_topics import mismatched_bridges
from rtron.sources.workspace import Workspace
from rtron.vocabulary import (
    Direction,
    Endpoint,
    Node,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.names import TRANSFORM_TOPICS, TRANSFORMS
from rtron.vocabulary.remap_rules import expand_name, remaps_for_node

_LIFECYCLE_MANAGER = "nav2_lifecycle_manager"
_OWN_LISTENER = "/transform_listener_impl_"
"""How a node is called that a TransformListener makes for itself (tf2_ros)."""


@dataclass(slots=True, kw_only=True)
class Ros2Assembly(GraphBuilder):
    """A graph in the making; nodes of one name stay apart in ROS 2, here they are one."""

    workspace: Workspace
    ros: int = 2
    remap_uses: RemapUses = field(default_factory=RemapUses)
    program_outputs: ProgramOutputs = field(default_factory=ProgramOutputs)
    frames: FrameBroadcasters = field(default_factory=lambda: FrameBroadcasters(ros=2))
    _gazebo_topics: list[GazeboTopic] = field(default_factory=list)
    _started: dict[str, AppNode] = field(default_factory=dict)

    def add_part(self, part: NodePart) -> None:
        """Add the nodes of a process or component, and what they declare."""
        declared: dict[str, list[Declaration]] = defaultdict(list)
        for declaration in part.interface.declarations:
            declared[declaration.node or part.node.name].append(declaration)
        for created in _created_nodes(part):
            self._add_node(created.name, part)
            self._note_remaps(created, part, declared[created.name])
            rules = _remap_rules(created, part)
            for entity in graph_entities(created.name, declared[created.name], rules):
                self.add_entity(entity)
                if isinstance(entity, Endpoint) and entity.direction is Direction.PUBLISH:
                    self.program_outputs.add(part, entity)
        self.add_wiring(*firmware(part), *last_messages(part), *message_flows(part))
        self.add_wiring(*sent_once(part))
        for created in islice(_created_nodes(part), 1):
            self.frames.add(part, _remap_rules(created, part)(TRANSFORMS))
            self.frames.activated.update(_activated_nodes(created.name, part))
        self.add_wiring(*_unreached_listeners(part))
        for parameter in part.interface.parameters:
            if "{" not in parameter.name:
                self.parameters[parameter.node, parameter.name] = parameter
        self._gazebo_topics += part.interface.gazebo_topics
        self.add_unresolved(*part.interface.unresolved)
        self.add_unresolved(*_programs_without_nodes(part))
        for started in part.interface.runtime_starts:
            why = "what a node starts itself is not followed: name it with --launch too"
            self.add_unresolved(started.unread(part.owner, why))

    def _note_remaps(
        self, created: CreatedNode, part: NodePart, declared: list[Declaration]
    ) -> None:
        rules = part.node.process_remap_rules if created.uses_global_arguments else ()
        remaps = {r.source: r.target for r in remaps_for_node(rules, created.name)}
        self.remap_uses.add(part, created.name, remaps, {each.name for each in declared})

    def add_wiring_facts(self) -> None:
        """Note what is wired in vain or twice: remaps, parameters; outputs and frames."""
        self.add_wiring(*self.remap_uses.idle(self.endpoints.values()))
        self.add_wiring(*self.remap_uses.unread())
        self.add_wiring(*self.program_outputs.second_sources())
        self.add_wiring(*self.program_outputs.shared(), *mismatched_bridges(self._gazebo_topics))
        self.add_wiring(*self.frames.facts(), *self.frames.loops())
        self.add_wiring(*self.frames.stray_frames(), *self.frames.missing_frames())
        values = (
            (f"{each.node}/{each.name}", each.value, self._started[each.node].evidence)
            for each in self.parameters.values()
            if each.node in self._started
        )
        topics = {end.topic for end in self.endpoints.values()} | self.remap_uses.sources
        self.add_wiring(*unused_topic_parameters(values, topics))

    def _add_node(self, name: str, part: NodePart) -> None:
        node = part.node
        first = self._started.setdefault(name, node)
        if name not in self.nodes:
            self.nodes[name] = Node(
                name=name,
                package=node.package,
                executable=node.type,
                origin=node.origin,
                trust=self.workspace.trust(node.package),
                unread=part.is_unread,
                process=_process(name, node),
            )
        elif "{" not in name and may_both_start(first, node):
            self.add_wiring(
                WiringFact(
                    kind=WiringFactKind.DUPLICATE_NODE,
                    subject=name,
                    others=(first.program, node.program),
                    evidence=(first.evidence, node.evidence),
                )
            )


def _process(name: str, started: AppNode) -> str:
    """Return the node in whose process a node runs, empty if it is its own."""
    process = started.container or started.name
    return "" if process == name else process


def _unreached_listeners(part: NodePart) -> Iterator[WiringFact]:
    """Yield a fact for each topic of transforms that a node remaps, but not for its listener."""
    created = list(_created_nodes(part))
    for listener in (each for each in created[1:] if _OWN_LISTENER in each.name):
        rules = _remap_rules(created[0], part), _remap_rules(listener, part)
        for topic in TRANSFORM_TOPICS:
            remapped, default = (of_node(topic) for of_node in rules)
            if remapped not in (topic, default):
                yield WiringFact(
                    kind=WiringFactKind.UNREACHED_LISTENER,
                    subject=created[0].name,
                    value=remapped,
                    others=(default,),
                    evidence=(part.node.evidence, *listener.evidence),
                )


def _remap_rules(created: CreatedNode, part: NodePart) -> RemapRules:
    of_process = part.node.process_remap_rules if created.uses_global_arguments else ()
    distribution = dict(part.node.site.environ).get("ROS_DISTRO", "")
    return RemapRules((*created.remaps, *of_process), created.name, distribution)


def _activated_nodes(name: str, part: NodePart) -> Iterator[str]:
    """Yield the nodes that a lifecycle manager of Nav2 activates when it starts."""
    if part.node.package == _LIFECYCLE_MANAGER:
        names = parameter_value(part.node.site, name, "node_names")
        is_started = parameter_value(part.node.site, name, "autostart") is True
        for each in names if is_started and isinstance(names, (list, tuple)) else ():
            yield expand_name(str(each), name)


def _programs_without_nodes(part: NodePart) -> Iterator[UnresolvedItem]:
    """Yield a note on a program whose source is here and makes no node: code elsewhere may."""
    node, interface = part.node, part.interface
    is_program = part.task is not None and not _is_hardware(part)
    if is_program and not (interface.declarations or interface.nodes):
        what = f"node {node.name} ({node.package}/{node.type})"
        why = "its source is here, and no node is seen that it makes"
        yield UnresolvedItem(what=what, why=why, evidence=(node.evidence,))


def _is_hardware(part: NodePart) -> bool:
    """Return whether a part is hardware of ros2_control, which needs no node of its own."""
    return part.task is not None and part.task.kind is TaskKind.HARDWARE


def _created_nodes(part: NodePart) -> Iterator[CreatedNode]:
    """Yield the nodes of a process; where its source tells of none, that which the launch names."""
    names = {created.name for created in part.interface.nodes}
    yield from part.interface.nodes
    others = dict.fromkeys(d.node or part.node.name for d in part.interface.declarations)
    is_named = names or _is_hardware(part)
    for name in others if is_named else (others or {part.node.name: None}):
        if name not in names:
            yield CreatedNode(name=name)


def duplicate_nodes(parts: Iterable[NodePart]) -> Iterator[WiringFact]:
    """Yield a fact for each node that certainly starts more than once."""
    parts_by_identity: dict[Hashable, list[NodePart]] = defaultdict(list)
    for part in parts:
        if not part.node.is_uncertain and "{" not in node_name(part):
            parts_by_identity[_node_identity(part)].append(part)
    for first, *others in parts_by_identity.values():
        if others:
            kind, places = WiringFactKind.DUPLICATE_NODE, (first.node.evidence,)
            yield WiringFact(kind=kind, subject=node_name(first), evidence=places)


def _node_identity(part: NodePart) -> Hashable:
    """Return what is alike; a node that is not named may take its name from its arguments.

    Nodes of one name are two of one name whatever their remaps; those of a program that was not
    read may call themselves as they like.
    """
    node, site = part.node, part.node.site
    is_named = site.has_launch_name or not part.is_unread
    return (
        node_name(part),
        node.evidence,
        () if is_named else node.process_remap_rules,
        () if site.has_launch_name else site.args,
    )

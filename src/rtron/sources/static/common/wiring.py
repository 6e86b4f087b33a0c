"""What a launch wires in vain: remaps that change no name, and topics that instances share."""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations
from typing import TypeAlias

from rtron.sources.models.common.arguments import has_option, option, positional
from rtron.sources.static.common.app_node import AppNode, may_both_start
from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import (
    Endpoint,
    Evidence,
    LaunchRemap,
    ParameterValue,
    WiringFact,
    WiringFactKind,
    fits_open_name,
    normalise_type,
)
from rtron.vocabulary.launch import resolve_name
from rtron.vocabulary.parameters import pattern_matches

_NODELET = "nodelet"
_JOINTS = "sensor_msgs/JointState"
_OF_ONE_SOURCE = frozenset({"rosgraph_msgs/Clock", "nav_msgs/OccupancyGrid", _JOINTS})
_OF_ALL_JOINTS = ("joint_state_publisher", "joint_state_publisher_gui")
"""Packages whose node publishes each joint of the robot; of other nodes each may have its own."""
_REPEATED = "-r --rate"
_ONCE, _TIMES = "-1 --once", "-t --times"
_FEW = 10
"""A `topic pub` that sends more messages is a stream."""
_NAME = re.compile(r"[~/]?\w+(?:/\w+)*", re.ASCII)
_Remap: TypeAlias = tuple[str, str]
_Program: TypeAlias = tuple[str, ...]


@dataclass(slots=True)
class RemapUses:
    """Which nodes get a remap, where, and whether it changes a name of any of them.

    A remap in a group goes to all its nodes, and most of them have no use for it: it is idle only
    if no node has.
    """

    _nodes: dict[_Remap, dict[str, Evidence]] = field(default_factory=lambda: defaultdict(dict))
    _used: set[_Remap] = field(default_factory=set)
    _of_models: set[_Remap] = field(default_factory=set)
    _of_open_nodes: set[_Remap] = field(default_factory=set)
    _unread: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))

    def add(
        self, part: NodePart, node: str, remaps: Mapping[str, str], names: Collection[str]
    ) -> None:
        """Note the remaps of a node of a part, which declares `names`.

        A node that was not read, or a hole in a name, may use any; a model of ROS 2 may lack some.
        """
        if part.is_unread:
            self._unread[node].update(remaps.values(), _given_names(part, node))
        for remap in remaps.items():
            self._nodes[remap][node] = part.node.evidence
            if part.is_unread or remap[0] in names or fits_open_name(remap[0], names):
                self._used.add(remap)
            if part.model and part.node.site.ros > 1:
                self._of_models.add(remap)
            if not part.is_whole or any(remap[0].startswith(f"{name}/") for name in names):
                self._of_open_nodes.add(remap)

    def add_behind_all(self, remap: LaunchRemap) -> None:
        """Note a remap that no node gets."""
        self._nodes[remap.source, remap.target].setdefault("", remap.evidence)
        self._of_open_nodes.add((remap.source, remap.target))

    @property
    def sources(self) -> set[str]:
        """The names that remaps lead away from."""
        return {source for source, _ in self._nodes}

    def unread(self) -> Iterator[WiringFact]:
        """Yield a fact for each node that was not read, with the names that the launch gives it."""
        for node, names in self._unread.items():
            kind, others = WiringFactKind.UNREAD_NODE, tuple(sorted(names))
            yield WiringFact(kind=kind, subject=node, others=others)

    def idle(
        self, endpoints: Iterable[Endpoint], parameters: Collection[str] = ()
    ) -> Iterator[WiringFact]:
        """Yield facts for each idle remap: who gets it, and who else uses its name, or one below.

        That nobody uses the name is noted where those who get it were read whole. It may be one of
        `parameters`, too.
        """
        users: dict[str, set[str]] = defaultdict(set)
        for end in endpoints:
            users[end.topic].add(end.node)
        used_names = {(_last(source), _last(target)) for source, target in self._used}
        for remap, nodes in self._nodes.items():
            source, target = remap
            if source == target or remap in self._used:
                continue
            others = {
                node
                for topic, of_topic in users.items()
                if topic == source or topic.startswith(f"{source}/")
                for node in of_topic - nodes.keys()
            }
            yield _fact(WiringFactKind.UNUSED_REMAP, remap, nodes, nodes.values())
            is_used = (_last(source), _last(target)) in used_names
            is_parameter = not {source, target}.isdisjoint(parameters)
            may_be_used = is_used or is_parameter or remap in self._of_open_nodes
            if remap not in self._of_models and (others or not may_be_used):
                yield _fact(WiringFactKind.IDLE_REMAP, remap, others, nodes.values())


def _given_names(part: NodePart, node: str) -> Iterator[str]:
    """Yield what the parameters of a node give it that may be names of topics."""
    site = part.node.site
    values: list[ParameterValue] = [value for _, value in site.overrides]
    values += [each.value for each in site.settings if pattern_matches(each.node, node)]
    values += [
        leaf.value for name, leaf in site.parameters.leaves.items() if name.startswith(f"{node}/")
    ]
    for value in values:
        if isinstance(value, str) and _NAME.fullmatch(value):
            yield resolve_name(value, node)


def _fact(
    kind: WiringFactKind, remap: _Remap, others: Iterable[str], places: Iterable[Evidence]
) -> WiringFact:
    return WiringFact(
        kind=kind,
        subject=remap[0],
        value=remap[1],
        others=tuple(sorted(filter(None, others))),
        evidence=tuple(dict.fromkeys(places)),
    )


def _last(name: str) -> str:
    return name.rpartition("/")[2]


def sent_once(part: NodePart) -> Iterator[WiringFact]:
    """Yield a fact for a `topic pub` that ends or rests after its message.

    That of ROS 1 does without a rate, that of ROS 2 if it is told to send a few messages.
    """
    node = part.node
    times = option(node.site.args, _TIMES) or ""
    is_counted = times.isascii() and times.isdigit() and 0 < int(times[:9]) <= _FEW
    is_once = {
        "rostopic": not has_option(node.site.args, _REPEATED),
        "ros2topic": is_counted or has_option(node.site.args, _ONCE),
    }
    names = {each.name for each in part.interface.nodes} or {part.owner}
    for name in names if is_once.get(node.package) else ():
        kind = WiringFactKind.SENT_ONCE
        yield WiringFact(kind=kind, subject=name, evidence=(node.evidence,))


@dataclass(slots=True)
class ProgramOutputs:
    """What each instance of a program publishes: nodes, and nodelets by the class they load.

    Of what has one source in an app, a clock, a map or a joint, all publishers are noted.
    """

    _sources: dict[tuple[str, bool], dict[str, AppNode]] = field(
        default_factory=lambda: defaultdict(dict)
    )
    _topics: dict[_Program, dict[str, set[str]]] = field(default_factory=dict)
    _places: dict[str, Evidence] = field(default_factory=dict)

    def add(self, part: NodePart, end: Endpoint) -> None:
        """Note a publisher of an instance, unless its client library adds it."""
        node, topic = part.node, end.topic
        if end.implicit:
            return
        type = normalise_type(end.type)
        if type in _OF_ONE_SOURCE and "{" not in topic + end.node:
            self._sources[topic, type == _JOINTS].setdefault(end.node, node)
        instances = self._topics.setdefault(_program(part), defaultdict(set))
        instances[node.name].add(topic)
        self._places[node.name] = node.evidence

    def second_sources(self) -> Iterator[WiringFact]:
        """Yield a fact for each clock, map and joint that more than one publishes for sure."""
        for (topic, is_joints), nodes in self._sources.items():
            pairs = combinations(nodes.values(), 2)
            is_one = not is_joints or any(n.package in _OF_ALL_JOINTS for n in nodes.values())
            if is_one and len(nodes) > 1 and all(may_both_start(*pair) for pair in pairs):
                yield WiringFact(
                    kind=WiringFactKind.SECOND_SOURCE,
                    subject=topic,
                    others=tuple(sorted(nodes)),
                    evidence=tuple(nodes[name].evidence for name in sorted(nodes)),
                )

    def shared(self) -> Iterator[WiringFact]:
        """Yield a fact for each topic that all instances share, where each has others alone."""
        for instances in self._topics.values():
            common = set.intersection(*instances.values())
            all_differ = all(topics - common for topics in instances.values())
            if len(instances) > 1 and all_differ:
                names = tuple(sorted(instances))
                places = tuple(self._places[name] for name in names)
                sources = {topic for topic, _ in self._sources}
                for topic in sorted(each for each in common - sources if "{" not in each):
                    kind = WiringFactKind.SHARED_OUTPUT
                    yield WiringFact(kind=kind, subject=topic, others=names, evidence=places)


def _program(part: NodePart) -> _Program:
    node = part.node
    loads = positional(node.site.args, "")[1:2] if node.package == _NODELET else []
    return (node.package, node.type, *loads)

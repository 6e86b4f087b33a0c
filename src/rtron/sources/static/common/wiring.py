"""What a launch wires in vain: remaps that change no name, and topics that instances share."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.models.common.arguments import positional
from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import (
    Endpoint,
    Evidence,
    LaunchRemap,
    WiringFact,
    WiringFactKind,
    fits_open_name,
)

_NODELET = "nodelet"
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

    def add(
        self,
        node: str,
        remaps: Mapping[str, str],
        names: Collection[str] | None,
        location: Evidence,
    ) -> None:
        """Note the remaps of a node that declares `names`; None, or a hole in one, may be any."""
        for remap in remaps.items():
            self._nodes[remap][node] = location
            if names is None or remap[0] in names or fits_open_name(remap[0], names):
                self._used.add(remap)

    def add_behind_all(self, remap: LaunchRemap) -> None:
        """Note a remap that no node gets."""
        self._nodes[remap.source, remap.target].setdefault("", remap.evidence)

    @property
    def sources(self) -> set[str]:
        """The names that remaps lead away from."""
        return {source for source, _ in self._nodes}

    def idle(self, endpoints: Iterable[Endpoint]) -> Iterator[WiringFact]:
        """Yield a fact for each idle remap whose name, or one below it, other nodes use."""
        users: dict[str, set[str]] = defaultdict(set)
        for end in endpoints:
            users[end.topic].add(end.node)
        for (source, target), nodes in self._nodes.items():
            others = {
                node
                for topic, of_topic in users.items()
                if topic == source or topic.startswith(f"{source}/")
                for node in of_topic - nodes.keys()
            }
            if others and source != target and (source, target) not in self._used:
                yield WiringFact(
                    kind=WiringFactKind.IDLE_REMAP,
                    subject=source,
                    value=target,
                    others=tuple(sorted(others)),
                    evidence=tuple(dict.fromkeys(nodes.values())),
                )


@dataclass(slots=True)
class ProgramOutputs:
    """What each instance of a program publishes: nodes, and nodelets by the class they load."""

    _topics: dict[_Program, dict[str, set[str]]] = field(default_factory=dict)
    _places: dict[str, Evidence] = field(default_factory=dict)

    def add(self, part: NodePart, topic: str) -> None:
        """Note a topic that an instance publishes."""
        node = part.node
        instances = self._topics.setdefault(_program(part), defaultdict(set))
        instances[node.name].add(topic)
        self._places[node.name] = node.evidence

    def shared(self) -> Iterator[WiringFact]:
        """Yield a fact for each topic that all instances share, where each has others alone."""
        for instances in self._topics.values():
            common = set.intersection(*instances.values())
            all_differ = all(topics - common for topics in instances.values())
            if len(instances) > 1 and all_differ:
                names = tuple(sorted(instances))
                places = tuple(self._places[name] for name in names)
                for topic in sorted(topic for topic in common if "{" not in topic):
                    kind = WiringFactKind.SHARED_OUTPUT
                    yield WiringFact(kind=kind, subject=topic, others=names, evidence=places)


def _program(part: NodePart) -> _Program:
    node = part.node
    loads = positional(node.site.args, "")[1:2] if node.package == _NODELET else []
    return (node.package, node.type, *loads)

"""Remaps of launch files that change no name, while the app uses the name elsewhere."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from rtron.vocabulary import Endpoint, Evidence, UnresolvedItem

NO_EFFECT = "no node that gets it uses the name"

_Remap = tuple[str, str]


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
        is_open = names is None or any("{" in name for name in names)
        for remap in remaps.items():
            self._nodes[remap][node] = location
            if is_open or remap[0] in (names or ()):
                self._used.add(remap)

    def idle(self, endpoints: Iterable[Endpoint]) -> Iterator[UnresolvedItem]:
        """Yield a note for each idle remap whose name, or one below it, other nodes use."""
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
                why = f"{NO_EFFECT}; {', '.join(sorted(others)[:3])} use it or one below it"
                places = tuple(dict.fromkeys(nodes.values()))
                yield UnresolvedItem(what=f"remap {source} to {target}", why=why, evidence=places)

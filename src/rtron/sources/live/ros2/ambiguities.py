"""What a ROS 2 graph leaves open: whose an end is, which of two, and in what type it speaks."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from rtron.vocabulary import Action, Evidence, Unresolved

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from rtron.sources.live.ros2.domain import Snapshot
    from rtron.wire.ros2.endpoints import Ros2Endpoint

_SHOWN = 8


def unnamed(participant: bytes) -> str:
    """Return what stands for the name of a participant's node that the domain does not tell."""
    return f"{{participant {participant.hex()}}}"


def strangers(seen: Snapshot) -> Iterator[Unresolved]:
    """Yield the participants with ends of which the domain tells no node."""
    count = Counter(end.participant for end in seen.ends if not end.node)
    for participant, ends in sorted(count.items()):
        why = f"has {ends} endpoints and does not say whose: no node of ROS 2, or still starting"
        yield Unresolved(what=unnamed(participant), why=why)


def doubles(seen: Snapshot) -> Iterator[Unresolved]:
    """Yield the names that several nodes have; each place is the id of a participant."""
    places: dict[str, set[bytes]] = defaultdict(set)
    for end in seen.ends:
        if end.node and end.gid:
            places[end.node].add(end.participant)
    nodes = Counter(seen.nodes)
    for name in sorted(nodes.keys() | places.keys()):
        found = places.get(name, set())
        number = max(nodes[name], len(found))
        if number > 1:
            where = "one process" if len(found) == 1 else f"{len(found)} processes"
            why = f"is the name of {number} nodes in {where}: it does not tell who speaks"
            evidence = tuple(Evidence(file=place.hex()) for place in sorted(found)[:_SHOWN])
            yield Unresolved(what=name, why=why, evidence=evidence)


def topic_types(endpoints: Iterable[Ros2Endpoint]) -> Iterator[Unresolved]:
    """Yield the topics whose ends speak different types, or one type in different definitions."""
    users: dict[str, dict[str, dict[str, str]]] = defaultdict(lambda: defaultdict(dict))
    for end in endpoints:
        users[end.topic][end.type].setdefault(end.type_hash, end.node)
    for topic, types in sorted(users.items()):
        if len(types) > 1:
            yield _mixed(topic, {type: min(nodes.values()) for type, nodes in types.items()})
        for type, nodes in sorted(types.items()):
            hashes = {hash: node for hash, node in nodes.items() if hash}
            if len(hashes) > 1:
                why = f"{type} has {len(hashes)} definitions here: {_listed(hashes.values())}"
                yield Unresolved(what=topic, why=f"{why} do not understand each other")


def action_types(actions: Iterable[Action]) -> Iterator[Unresolved]:
    """Yield the actions of which different types are told."""
    users: dict[str, dict[str, str]] = defaultdict(dict)
    for action in actions:
        users[action.name].setdefault(action.type, action.node)
    for name, types in sorted(users.items()):
        if len(types) > 1:
            yield _mixed(name, types)


def _mixed(name: str, types: Mapping[str, str]) -> Unresolved:
    told = _listed(f"{type or 'no type'} ({node})" for type, node in types.items())
    why = f"has {len(types)} types, which do not hear each other: {told}"
    return Unresolved(what=name, why=why)


def _listed(names: Iterable[str]) -> str:
    shown = sorted(names)
    more = f" and {len(shown) - _SHOWN} more" if len(shown) > _SHOWN else ""
    return ", ".join(shown[:_SHOWN]) + more

"""What a ROS 2 graph leaves open: whose an end is, which of two, and in what type it speaks."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from rtron.vocabulary import Action, Evidence, UnresolvedItem

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from rtron.sources.live.ros2.domain import Snapshot
    from rtron.wire.ros2.endpoints import Ros2Endpoint

_MAX_SHOWN = 8


def participant_placeholder(participant: bytes) -> str:
    """Return what stands for the name of a participant's node that the domain does not tell."""
    return f"{{participant {participant.hex()}}}"


def unnamed_participants(snapshot: Snapshot) -> Iterator[UnresolvedItem]:
    """Yield the participants with ends of which the domain tells no node."""
    count = Counter(
        endpoint.participant for endpoint in snapshot.all_endpoints if not endpoint.node
    )
    for participant, number in sorted(count.items()):
        why = f"has {number} endpoints and does not say whose: no node of ROS 2, or still starting"
        yield UnresolvedItem(what=participant_placeholder(participant), why=why)


def duplicate_nodes(snapshot: Snapshot) -> Iterator[UnresolvedItem]:
    """Yield the names that several nodes have; each place is the id of a participant."""
    participants_by_node: dict[str, set[bytes]] = defaultdict(set)
    for endpoint in snapshot.all_endpoints:
        if endpoint.node and endpoint.gid:
            participants_by_node[endpoint.node].add(endpoint.participant)
    nodes = Counter(snapshot.nodes)
    for name in sorted(nodes.keys() | participants_by_node.keys()):
        participants = participants_by_node.get(name, set())
        number = max(nodes[name], len(participants))
        if number > 1:
            processes = (
                "one process" if len(participants) == 1 else f"{len(participants)} processes"
            )
            why = f"is the name of {number} nodes in {processes}: it does not tell who speaks"
            evidence = tuple(
                Evidence(file=participant.hex())
                for participant in sorted(participants)[:_MAX_SHOWN]
            )
            yield UnresolvedItem(what=name, why=why, evidence=evidence)


def topic_type_conflicts(endpoints: Iterable[Ros2Endpoint]) -> Iterator[UnresolvedItem]:
    """Yield the topics whose ends speak different types, or one type in different definitions."""
    users: dict[str, dict[str, dict[str, str]]] = defaultdict(lambda: defaultdict(dict))
    for endpoint in endpoints:
        users[endpoint.topic][endpoint.type].setdefault(endpoint.type_hash, endpoint.node)
    for topic, types in sorted(users.items()):
        if len(types) > 1:
            yield _type_conflict(
                topic, {type: min(nodes.values()) for type, nodes in types.items()}
            )
        for type, nodes in sorted(types.items()):
            hashes = {hash: node for hash, node in nodes.items() if hash}
            if len(hashes) > 1:
                why = f"{type} has {len(hashes)} definitions here: {_shown_names(hashes.values())}"
                yield UnresolvedItem(what=topic, why=f"{why} do not understand each other")


def action_type_conflicts(actions: Iterable[Action]) -> Iterator[UnresolvedItem]:
    """Yield the actions of which different types are told."""
    users: dict[str, dict[str, str]] = defaultdict(dict)
    for action in actions:
        users[action.name].setdefault(action.type, action.node)
    for name, types in sorted(users.items()):
        if len(types) > 1:
            yield _type_conflict(name, types)


def _type_conflict(name: str, types: Mapping[str, str]) -> UnresolvedItem:
    shown_types = _shown_names(f"{type or 'no type'} ({node})" for type, node in types.items())
    why = f"has {len(types)} types, which do not hear each other: {shown_types}"
    return UnresolvedItem(what=name, why=why)


def _shown_names(names: Iterable[str]) -> str:
    shown = sorted(names)
    more = f" and {len(shown) - _MAX_SHOWN} more" if len(shown) > _MAX_SHOWN else ""
    return ", ".join(shown[:_MAX_SHOWN]) + more

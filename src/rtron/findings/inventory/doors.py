"""The doors of an app: what lets others than its ROS nodes command it, from a network."""

from collections.abc import Collection, Iterable, Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.node_kinds import bridges
from rtron.vocabulary import WiringFactKind


def doors(
    app: AppFacts, drivers: Iterable[str] = (), senders: Iterable[str] = ()
) -> tuple[str, ...]:
    """Return the bridges, which reach everything, and the nodes that have a way in of their own.

    Each is a node or a package, with how it is reached. A link to an autopilot is a way into that
    alone, so no way to what its node sends.
    """
    open_to_all = [f"{name} (any client)" for name in bridges(app)]
    own = _own_doors(app, frozenset(drivers), frozenset(senders))
    return tuple(dict.fromkeys([*open_to_all, *own]))


def has_door(app: AppFacts, node: str) -> bool:
    """Return whether a node has a way in of its own, from a network."""
    return any(
        each.kind is WiringFactKind.SOCKET and each.subject == node for each in app.graph.wiring
    )


def _own_doors(app: AppFacts, drivers: frozenset[str], senders: frozenset[str]) -> Iterator[str]:
    for fact in app.graph.wiring:
        nodes = drivers if fact.value == "MAVLink link" else drivers | senders
        if fact.kind is WiringFactKind.SOCKET and fact.subject in nodes:
            yield f"{fact.subject} ({fact.value})"


def operators(app: AppFacts, nodes: Collection[str]) -> tuple[str, ...]:
    """Return which of some nodes a person commands beside ROS, each with what he does it by."""
    facts = (fact for fact in app.graph.wiring if fact.kind is WiringFactKind.OPERATOR)
    return tuple(f"{fact.subject} ({fact.value})" for fact in facts if fact.subject in nodes)

"""The doors of an app: what lets others than its ROS nodes command it, from a network."""

from collections.abc import Iterable, Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.motion.network_bridge import bridges
from rtron.vocabulary import WiringFactKind


def doors(app: AppFacts, senders: Iterable[str]) -> tuple[str, ...]:
    """Return the bridges, which reach everything, and the senders that have a way in of their own.

    Each is a node or a package, with how it is reached.
    """
    open_to_all = [f"{name} (any client)" for name in bridges(app)]
    return tuple(dict.fromkeys([*open_to_all, *_of_senders(app, frozenset(senders))]))


def _of_senders(app: AppFacts, senders: frozenset[str]) -> Iterator[str]:
    for fact in app.graph.wiring:
        if fact.kind is WiringFactKind.SOCKET and fact.subject in senders:
            yield f"{fact.subject} ({fact.value})"

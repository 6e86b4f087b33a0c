"""A cell: the network of one node, and what passes between it and the app.

The guard carries the topics of the plan's streams itself; a manifest lists the rest.
"""

import re
from dataclasses import dataclass

from rtron.vocabulary.names import PRIVATE_ROOT, SUPERVISOR_NODE, matches_node
from rtron.vocabulary.plan import Plan
from rtron.vocabulary.topic_access import list_topic_access

CELL_SCHEMA = "rtron.cell/1"
_FULL_NAME = re.compile(r"(?:/\w+)+", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class CarriedTopic:
    """A topic that passes; `publishers` are the only ones that may speak there."""

    topic: str
    type: str = ""
    publishers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CarriedService:
    """A service that passes; `clients` are the only ones that may call it."""

    service: str
    type: str = ""
    clients: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CellManifest:
    """What passes between the cell of a node and the app, beside the streams of the plan.

    `published` and `served` go out, `subscribed` and `called` go in. `parameters` are names and
    namespaces that are copied into the cell before the node starts.
    """

    node: str
    published: tuple[CarriedTopic, ...] = ()
    subscribed: tuple[CarriedTopic, ...] = ()
    served: tuple[CarriedService, ...] = ()
    called: tuple[CarriedService, ...] = ()
    parameters: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CellTopics:
    """The private topics of the plan that a node in a cell subscribes and publishes.

    `shared` are those of them that a node outside subscribes or publishes, too.
    """

    subscribed: frozenset[str]
    published: frozenset[str]
    shared: frozenset[str]


def may_pass(name: str) -> bool:
    """Tell whether a topic or service may be listed: the guard's own would lead past the guard.

    Masters resolve what is no full name, so it may mean another one there.
    """
    return _FULL_NAME.fullmatch(name) is not None and not name.startswith(PRIVATE_ROOT + "/")


def cell_topics(plan: Plan, node: str) -> CellTopics:
    """Return the private topics of a plan's enforced streams that a node has a side in."""
    access = [each for each in list_topic_access(plan) if each.topic.startswith(PRIVATE_ROOT + "/")]
    subscribed = {each.topic: each.subscribers for each in access if each.may_subscribe(node)}
    published = {each.topic: each.publishers for each in access if each.may_publish(node)}
    sides = (*subscribed.items(), *published.items())
    shared = {topic for topic, names in sides if any(_is_outside(plan, name) for name in names)}
    return CellTopics(
        subscribed=frozenset(subscribed), published=frozenset(published), shared=frozenset(shared)
    )


def _is_outside(plan: Plan, name: str) -> bool:
    """Tell whether a node of the plan is neither the guard's nor in a cell."""
    is_own = name == SUPERVISOR_NODE or name.startswith(PRIVATE_ROOT + "/")
    return not is_own and not any(matches_node(name, each) for each in plan.cell)

"""A node calls a service or an action that nobody offers, and another one may be meant.

## What it finds

A client of a service or an action without a server, while one with a near name and the same type
has a server. Of an action it may have any name: the only one of its type that nobody calls. Or a
client of a service below the name of a node that does not offer it: your own, or of a lifecycle
that the node does not have. The client waits in vain.

For example, `/mission` sends goals to `/navigate_to_pos`, and `/bt_navigator` serves
`/navigate_to_pose`; or MoveIt calls `/arm_controller/follow_joint_trajectory`, and the spawner
starts `/trajectory_controller`.

## What to do

Correct the name.

## When it is silent

Where none is likely meant (`incomplete_launch`), between twins (`left_arm`, `right_arm`), between
actions whose names tell of different parts (`arm_controller`, `gripper_controller`), and for calls
of a lifecycle manager (`missing_managed_node`).
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.things import thing_of_node
from rtron.findings.lost_commands import are_twins
from rtron.findings.near_names import near_names
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring.missing_managed_node import is_managing
from rtron.vocabulary import (
    ActionRole,
    Certainty,
    Consequence,
    Finding,
    FindingLevel,
    Service,
    ServiceClient,
    Trust,
    fits_open_name,
)
from rtron.vocabulary.inventory import Thing
from rtron.wording import conjugate, join_names

_LIFECYCLE = "lifecycle_msgs/"
"""The types of services that a node has all of or none, as a model of it says."""


class _RequestSide(NamedTuple):
    """One side of a service or an action."""

    what: str
    name: str
    node: str
    type: str
    implicit: bool = False


class UnservedName(NamedTuple):
    """What nodes call and nobody offers, those that are offered and may be meant, and the node.

    The node is the one below whose name it is called, if that certainly does not offer it.
    """

    what: str
    nodes: list[str]
    near: list[str]
    owner: str


_OF_EVERY_NODE = frozenset({"get_loggers", "set_logger_level"})
"""What roscpp and rospy offer in each node (wiki.ros.org/rosconsole)."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each name with a client and no server, while another may be meant."""
    for name, unserved in unserved_names(app).items():
        if unserved.near or unserved.owner:
            yield _finding(app, name, unserved)


@lru_cache(maxsize=1)
def unserved_names(app: AppFacts) -> Mapping[str, UnservedName]:
    """Return what is called and not offered, by its name."""
    offers = _offers(app)
    calls = [*_sides("service", app.graph.clients), *_actions(app, ActionRole.CLIENT)]
    served = {(offer.what, offer.name) for offer in offers}
    unserved: dict[str, list[_RequestSide]] = defaultdict(list)
    for call in calls:
        counts = not call.implicit and "{" not in call.name and call.node not in app.facts.viewers
        counts &= not is_managing(app, call.node, call.name)
        if counts and (call.what, call.name) not in served:
            unserved[call.name].append(call)
    called = {(call.what, call.name) for call in calls}
    spare = [offer for offer in offers if (offer.what, offer.name) not in called]
    missing = [call for of_name in unserved.values() for call in of_name]
    found = {}
    for name, calls_of_it in sorted(unserved.items()):
        near = _near_servers(calls_of_it, offers) or _only_server(name, missing, spare)
        what = " and ".join(sorted({call.what for call in calls_of_it}))
        nodes = sorted({call.node for call in calls_of_it})
        near = [each for each in near if not are_twins(name, each)]
        found[name] = UnservedName(what, nodes, near, _owner(app, calls_of_it[0]))
    return found


def _owner(app: AppFacts, call: _RequestSide) -> str:
    """Return the node that a service belongs to by its name, if what it offers is known."""
    name, _, service = call.name.rpartition("/")
    if service in _OF_EVERY_NODE:
        return ""
    node = app.nodes.get(name) if call.what == "service" else None
    is_known = node and (node.trust is Trust.OWN or call.type.startswith(_LIFECYCLE))
    return name if node and is_known and not node.unread else ""


def _only_server(name: str, missing: list[_RequestSide], spare: list[_RequestSide]) -> list[str]:
    """Return the only action of the type that nobody calls, where only this name misses one."""
    type = next((each.type for each in missing if each.name == name and each.what == "action"), "")
    called, offered = (
        {each.name for each in sides if type and (each.what, each.type) == ("action", type)}
        for sides in (missing, spare)
    )
    is_only = len(called) == len(offered) == 1 and not any("{" in each for each in offered)
    return list(offered) if is_only and len(_parts_of_robot([name, *offered])) <= 1 else []


def _parts_of_robot(names: list[str]) -> set[Thing]:
    """Return what the names tell that they move, of each the first that it tells."""
    things = (filter(None, map(thing_of_node, name.split("/"))) for name in names)
    return {thing for of_name in things for thing in [next(of_name, None)] if thing}


def _offers(app: AppFacts) -> list[_RequestSide]:
    return [*_sides("service", app.graph.services), *_actions(app, ActionRole.SERVER)]


def _sides(what: str, sides: Iterable[Service | ServiceClient]) -> Iterator[_RequestSide]:
    for each in sides:
        yield _RequestSide(what, each.name, each.node, each.type, each.implicit)


def _actions(app: AppFacts, role: ActionRole) -> Iterator[_RequestSide]:
    for each in app.graph.actions:
        if each.role is role:
            yield _RequestSide("action", each.name, each.node, each.type)


def _near_servers(calls: list[_RequestSide], offers: list[_RequestSide]) -> list[str]:
    """Return what has a near name and, as far as it is known, the same type."""
    types = {(call.what, call.type) for call in calls}
    return near_names(
        calls[0].name,
        {
            offer.name
            for offer in offers
            if "{" not in offer.name and any(_fits(offer, *each) for each in types)
        },
    )


def _fits(offer: _RequestSide, what: str, type: str) -> bool:
    """Return whether an offer may be meant; one that a library adds must be of the known type."""
    is_open = not (offer.implicit or (offer.type and type))
    return offer.what == what and (is_open or offer.type == type != "")


def _finding(app: AppFacts, name: str, unserved: UnservedName) -> Finding:
    what, nodes, near, owner = unserved
    is_read = app.is_whole and not fits_open_name(name, (offer.name for offer in _offers(app)))
    return make_finding(
        RULE.name,
        name,
        summary=f"{join_names(nodes)} {conjugate(nodes, 'call')} the {what} {name}, "
        "which nobody offers",
        cause=f"{owner} is here and does not offer it"
        if owner
        else f"no node of this launch offers it{app.unread_hint}",
        remedy=f"did you mean {near[0]}?" if near else f"call what {owner} offers, or add it there",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY if is_read else Certainty.POSSIBLE,
        level=FindingLevel.REGULAR if is_read else FindingLevel.PEDANTIC,
        meant="".join(near[:1]),
        nodes=nodes,
        topics=(name,),
        evidence=app.node_evidence([*nodes, *(o.node for o in _offers(app) if o.name in near[:1])]),
    )


RULE = FindingRule(
    name="no_server",
    title="A node calls a service or an action that nobody offers, and another one may be meant",
    consequence="failure: likely where all nodes were read, else possible",
    since="0.1.0",
    check=check,
)

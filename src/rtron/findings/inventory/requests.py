"""What is asked for one by one: the services and actions of an app that move something."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator

from rtron.findings.inventory.things import may_be_command, thing_of
from rtron.vocabulary import Action, ActionRole, InteractionGraph, Service, ServiceClient
from rtron.vocabulary.inventory import Command, Means, Thing

_COMPUTING = (
    "ComputePath",
    "SmoothPath",
    "LookupTransform",
    "ComputeRoute",
    "GetPlan",
    "GetMap",
    "/Wait",
)
"""Actions that only compute, or wait."""


def services(
    graph: InteractionGraph,
    drivers: Collection[str],
    devices: Collection[str],
    viewers: Collection[str],
) -> Iterator[tuple[Thing, Command]]:
    """Yield the services that move something: those that are offered, and those only called.

    What a viewer offers or calls, and nobody else offers, does not.

    Whatever a driver offers may move something. So may all that a node next to hardware offers
    (`devices`), if one of its services says that it moves something.
    """
    moving = {
        each.node
        for each in graph.services
        if each.node in devices and thing_of(each.name, each.type, Means.SERVICE) is not None
    }
    drivers = moving.union(drivers)
    offered = {(each.name, each.type) for each in graph.services if not each.implicit}
    names = {name for name, _ in offered}
    called = {(c.name, c.type) for c in graph.clients if not c.implicit and c.name not in names}
    servers_of, callers_of = _nodes(graph.services), _nodes(graph.clients)
    for name, type in sorted(offered | called):
        servers = servers_of[name]
        if not (servers or callers_of[name]).difference(viewers):
            continue
        thing = thing_of(name, type, Means.SERVICE)
        if thing is None and not servers.isdisjoint(drivers) and may_be_command(name, type):
            thing = Thing.DEVICE
        if thing is not None and not _is_unnamed(name):
            callers = callers_of[name] - servers
            yield thing, _command(Means.SERVICE, name, type, servers, callers)


def actions(
    graph: InteractionGraph, active: Collection[str], viewers: Collection[str]
) -> Iterator[tuple[Thing, Command]]:
    """Yield the actions that move something; whatever they serve that drive or command may.

    A viewer's button for what is not there moves nothing.
    """
    serving = _nodes(each for each in graph.actions if each.role is ActionRole.SERVER)
    asking = _nodes(each for each in graph.actions if each.role is ActionRole.CLIENT)
    for name, type in sorted({(each.name, each.type) for each in graph.actions}):
        servers, clients = serving[name], asking[name]
        thing = thing_of(name, type, Means.ACTION)
        if thing is None and not servers.isdisjoint(active) and may_be_command(name, type):
            thing = Thing.DEVICE
        if _is_unnamed(name) or any(word in type for word in _COMPUTING):
            continue
        if thing is not None and (servers or clients.difference(viewers)):
            yield thing, _command(Means.ACTION, name, type, servers, clients)


def _is_unnamed(name: str) -> bool:
    """Return whether even the last part of a name is not known whole."""
    return "{" in name.rpartition("/")[2]


def _nodes(sides: Iterable[Service | ServiceClient | Action]) -> dict[str, set[str]]:
    """Return the nodes of each name."""
    found = defaultdict[str, set[str]](set)
    for each in sides:
        found[each.name].add(each.node)
    return found


def _command(means: Means, name: str, type: str, receivers: set[str], senders: set[str]) -> Command:
    return Command(
        means=means,
        name=name,
        type=type,
        receivers=tuple(sorted(receivers)),
        senders=tuple(sorted(senders)),
    )

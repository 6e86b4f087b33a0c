"""The inventory of an app: what can move this robot, who commands it, and what else can."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import filterfalse

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.command_topics import STOPPING
from rtron.findings.inventory.commands import AppCommands
from rtron.findings.inventory.doors import doors, has_door, operators
from rtron.findings.inventory.limits import limits
from rtron.findings.inventory.node_roles import (
    FIRMWARE_PACKAGES,
    MOVING_HARDWARE,
    NodeRoles,
    may_drive_unread,
)
from rtron.findings.inventory.stopping import Stopping, goes_on, stopping
from rtron.findings.inventory.things import part_of_name, vagueness
from rtron.findings.measurement_names import moves_nothing
from rtron.findings.node_kinds import bridges, moves
from rtron.vocabulary.inventory import (
    NO_MOTION,
    SIGNALS,
    SWITCHES,
    Command,
    Means,
    Mover,
    Stops,
    Thing,
)
from rtron.vocabulary.names import snake_case
from rtron.wording import join_names

__all__ = ["take_inventory"]

MOST_MOVERS = 12
"""With more lines, those of one thing are one."""
_HOLDING = SWITCHES | {Thing.HEAD, Thing.GRIPPER, Thing.HORN}
"""What is told once, or holds what it was told: whether it stops when commands end says nothing."""
_APART = SWITCHES | {Thing.DEVICE}


@lru_cache(maxsize=1)
def take_inventory(app: AppFacts) -> tuple[Mover, ...]:
    """Return what can move the robot, in the order of `Thing`; empty where nothing is found."""
    commands = AppCommands(app, NodeRoles(app))
    groups: dict[tuple[Thing, tuple[str, ...]], list[Command]] = defaultdict(list)
    for thing, command in commands.last:
        groups[thing, command.receivers].append(command)
    merged = _merged(groups)
    movers = [_mover(app, commands, thing, found) for thing, found in merged]
    movers = _with_limits(movers, limits(app, commands))
    movers += [*_unread(app, movers), *_uncommanded_hardware(app, commands.roles, movers)]
    order = list(Thing)
    return tuple(sorted(movers, key=lambda each: order.index(each.thing)))


def _with_limits(movers: list[Mover], bounds: Mover | None) -> list[Mover]:
    """Return the lines with the parameters that bound motion, beside what else bounds it."""
    if bounds is None:
        return movers
    rest = [each for each in movers if each.thing is not Thing.LIMITS]
    for other in (each for each in movers if each.thing is Thing.LIMITS):
        drivers = tuple(dict.fromkeys((*other.drivers, *bounds.drivers)))
        commands = (*other.commands, *bounds.commands)
        bounds = replace(other, commands=commands, drivers=drivers)
    return [*rest, bounds]


def _unread(app: AppFacts, movers: Iterable[Mover]) -> Iterator[Mover]:
    """Yield the nodes that were not read, and whose names say that they move something.

    Where nobody that was read moves anything, each of them may.
    """
    listed = {node for mover in movers for node in mover.drivers}
    listed |= {*bridges(app)}
    packages = {
        node: app.nodes[node].package
        for node in app.unread_nodes
        if node not in listed and may_drive_unread(app.nodes[node])
    }
    named = [n for n, p in packages.items() if p in FIRMWARE_PACKAGES or moves(n, p)]
    has_driver = any(mover.drivers or mover.unread for mover in movers)
    if unread := named or (() if has_driver else tuple(packages)):
        yield Mover(thing=Thing.DEVICE, commands=(), drivers=tuple(unread), doors=doors(app))


def _uncommanded_hardware(app: AppFacts, roles: NodeRoles, movers: list[Mover]) -> Iterator[Mover]:
    """Yield the nodes with hardware that obey nothing of the app that moves.

    It can only move, or they have a person or a link of their own that commands it. Who commands
    others by topics may have the hardware's library from them.
    """
    moving = (mover for mover in movers if mover.thing not in NO_MOTION)
    listed = {node for mover in moving for node in mover.drivers}
    sending = {node for mover in movers for each in mover.last_commands for node in each.senders}
    listed |= set(filterfalse(roles.is_autopilot, sending))
    for node in filter(roles.is_actuating, sorted(app.nodes)):
        hardware = tuple(dict.fromkeys(fact.value for fact in roles.devices((node,))))
        persons = operators(app, {node})
        is_moving = persons or has_door(app, node) or not MOVING_HARDWARE.isdisjoint(hardware)
        if node not in listed and is_moving:
            yield Mover(
                thing=Thing.VEHICLE if roles.is_autopilot(node) else Thing.DEVICE,
                commands=(),
                drivers=(node,),
                hardware=hardware,
                doors=doors(app, (node,)),
                operators=persons,
            )


def _merged(
    groups: dict[tuple[Thing, tuple[str, ...]], list[Command]],
) -> Iterator[tuple[Thing, list[Command]]]:
    """Yield what is one line: all of a switch, all limits; requests with what they move.

    Where that gives too many, one line stands for a thing.
    """
    lines: dict[tuple[Thing, tuple[str, ...]], list[Command]] = defaultdict(list)
    moved = [key for key, found in groups.items() if any(c.means is Means.TOPIC for c in found)]
    first = {key[0]: key for key in reversed(moved)}
    apart = defaultdict[tuple[str, ...], list[tuple[Thing, tuple[str, ...]]]](list)
    for key in moved:
        apart[key[1]] += [key] if key[0] not in _APART and key[1] else []
    topics = frozenset(moved)
    for (thing, receivers), found in sorted(groups.items(), key=lambda g: g[0][0] is Thing.DEVICE):
        beside = apart.get(receivers, [])
        if thing in NO_MOTION:
            lines[thing, ()] += found
        elif thing is Thing.DEVICE and len(beside) == 1:
            lines[beside[0]] += found
        elif (thing, receivers) in topics:
            lines[thing, receivers] += found
        else:
            lines[first.get(thing, (thing, ()))] += found
    if len(lines) > MOST_MOVERS:
        wide = defaultdict[tuple[Thing, tuple[str, ...]], list[Command]](list)
        for (thing, _), found in lines.items():
            wide[thing, ()] += found
        lines = wide
    for (thing, _), found in lines.items():
        yield thing, found


def _unread_parts(app: AppFacts) -> tuple[str, ...]:
    """Return the nodes that were not read, else the first launch file that starts more."""
    nodes = tuple(
        node
        for node in app.unread_nodes
        if node not in bridges(app) and may_drive_unread(app.nodes[node])
    )
    files = (name for name in app.unread_files if ".launch" in name)
    return nodes or tuple(name for name in files if not moves_nothing(name))[:1]


def _mover(app: AppFacts, commands: AppCommands, thing: Thing, last: list[Command]) -> Mover:
    topics = [each for each in last if each.means is Means.TOPIC]
    streamed = [each for each in topics if each.type not in SIGNALS and goes_on(thing, each)]
    behind = list(commands.forwarding.behind(topics))
    goals = commands.forwarding.goals(each for each in last if each.means is Means.ACTION)
    requests = [each for each in last if each.means is not Means.TOPIC and thing not in NO_MOTION]
    upstream = [*(command for _, command in behind), *goals, *commands.forwarding.buttons(requests)]
    everything = _distinct([*last, *upstream])
    drivers = _nodes(each.receivers for each in (topics or last))
    opened = commands.roles.devices(drivers)
    moves_on = streamed and thing not in _HOLDING
    stops = stopping(app, drivers, streamed, behind) if moves_on else []
    unread = () if drivers else _unread_parts(app)
    is_seen = bool(unread) and unread[0] in app.nodes
    senders = _nodes(each.senders for each in everything)
    endpoints = [end for each in topics for end in app.graph.subscribers(each.name)]
    return Mover(
        thing=_named(thing, topics, everything),
        commands=everything,
        drivers=drivers,
        hardware=tuple(dict.fromkeys(fact.value for fact in opened)),
        arbiters=tuple(
            dict.fromkeys(node for node, _ in behind if commands.forwarding.decides(node))
        ),
        doors=doors(app, drivers, senders),
        operators=operators(app, {*drivers, *senders}),
        unprompted=() if thing in NO_MOTION else commands.forwarding.unprompted(topics),
        firmware=tuple(filter(commands.roles.is_sketch, drivers)),
        effect=_stop_effect(commands, drivers) if thing is Thing.STOP and topics else "",
        unread=unread,
        is_whole=not set(app.unread_nodes).difference(bridges(app)),
        stops=stops[0].stops if stops else Stops.UNKNOWN,
        stop=_why_it_stops(stops[0], is_seen=is_seen) if stops else "",
        holders=tuple((each.holder, each.why) for each in stops if each.holder),
        evidence=(*(place for fact in opened for place in fact.evidence), *app.evidence(endpoints)),
    )


def _stop_effect(commands: AppCommands, nodes: tuple[str, ...]) -> str:
    """Return what a stop does that no driver obeys, empty where one does or may."""
    if any(node in commands.topics.ranks for node in nodes):
        passing = commands.topics.passing_locks(nodes)
        return f"locks nothing that is ranked as high: {join_names(passing)}" if passing else ""
    is_read = bool(nodes) and not any(map(commands.roles.may_obey, nodes))
    return f"no driver obeys it: {join_names(nodes)} decides what stops" if is_read else ""


def _named(thing: Thing, last: list[Command], commands: Iterable[Command]) -> Thing:
    """Return what is moved: where the last topics do not say it, what stands behind them does."""
    if thing in NO_MOTION or not last or any(part_of_name(c.name, c.type) for c in last):
        return thing
    behind = [part_of_name(c.name, c.type) for c in commands if c.hops and c.means is Means.TOPIC]
    behind += [part_of_name(node, "") for each in last for node in each.senders]
    named = set(filter(None, behind))
    unnamed = Thing.DEVICE if thing is Thing.BASE else thing
    return next((each for each in Thing if each in named), unnamed)


def _why_it_stops(end: Stopping, *, is_seen: bool) -> str:
    is_unread = is_seen and end.stops is Stops.UNKNOWN
    return "what obeys was not read" if is_unread else end.why


def _distinct(commands: Iterable[Command]) -> tuple[Command, ...]:
    """Return each command once, by its shortest way, in the order of harm."""
    found: dict[tuple[Means, str], Command] = {}
    for each in sorted(commands, key=lambda command: command.hops):
        first = found.setdefault((each.means, each.name), each)
        if each.priority and not first.priority:
            found[each.means, each.name] = replace(first, priority=each.priority)
    return _by_harm(found.values())


def _by_harm(commands: Collection[Command]) -> tuple[Command, ...]:
    """Return commands in the order of harm, since reports tell the first of many only.

    What is next to the hardware goes first, and of requests those that lead to most others, then
    to most topics; of topics those that somebody sends. Then comes what says more clearly that it
    moves something, which comes first of what is behind. Mere signals come last, those that stop
    after those that start.
    """
    sent: dict[str, list[Command]] = defaultdict(list)
    for each in commands:
        for node in each.senders:
            sent[node].append(each)
    order = list(Means)

    def harm(command: Command) -> tuple[int, ...]:
        is_end = bool(STOPPING.match(snake_case(command.name.rpartition("/")[2])))
        is_signal = command.type in SIGNALS
        is_topic = command.means is Means.TOPIC
        led = [] if is_topic else _led(command, sent)
        requests = sum(each.means is not Means.TOPIC for each in led)
        vague = vagueness(command.name, command.type, command.means)
        first = (is_signal, is_signal and is_end, bool(command.hops), vague * bool(command.hops))
        is_open = is_topic and not command.senders
        last = (-requests, -len(led), is_open, vague)
        return *first, command.hops, order.index(command.means), *last

    return tuple(sorted(commands, key=harm))


def _led(command: Command, sent: Mapping[str, list[Command]]) -> list[Command]:
    """Return the other commands of the nodes that obey a command, and of those that obey these."""
    found, pending = {command.name: command}, [command]
    while pending:
        for node in pending.pop().receivers:
            further = {each.name: each for each in sent.get(node, ()) if each.name not in found}
            found |= further
            pending += further.values()
    return list(found.values())[1:]


def _nodes(groups: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(node for group in groups for node in group))

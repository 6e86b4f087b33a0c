"""What moves the robot: which commands a plan is to guard, and why it does not guard the others."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain

from rtron.coherence import guards_nothing
from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.node_roles import NodeRoles, unread_drivers
from rtron.findings.node_kinds import arbiters
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.vocabulary import Mode, Plan, Trust, UnguardedPath, build_streams
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Command, Means, Mover, Thing
from rtron.vocabulary.names import are_nested
from rtron.wording import conjugate, join_names
from rtron.workflows.scan import ScanResult


def last_commands(scan: ScanResult) -> dict[str, tuple[str, ...]]:
    """Return the topics that nodes next to the hardware obey, each with who may obey it unread.

    Switches, limits and mere signals are not among them: a stop, a reset or an order to land must
    come from anyone. Where one side of a topic is not in the app, its type and name must say that
    it commands motion: a driver hears, and sends, measurements, too. Where that is who obeys, a
    node that was not read may do it, if it is called like a driver and lies in a namespace of the
    topic's. No other: the remap would let what it publishes past the guard.
    Firmware behind rosserial may obey whatever others obey, too. What nobody here obeys goes to the
    firmware of the launch, but for what is sent only once: a guard keeps no command for later.

    So are the inputs of arbiters that nobody sends: who comes to send one goes before others.
    """
    moving = (mover for mover in scan.inventory if mover.thing not in NO_MOTION)
    open_inputs = _open_inputs(scan.app)
    commands = (
        c for mover in moving for c in mover.commands if not c.hops or c.name in open_inputs
    )
    topics = (c for c in commands if c.means is Means.TOPIC and c.type not in SIGNALS)
    unread = unread_drivers(scan.app)
    firmware = [node for node in unread if node in NodeRoles(scan.app).firmware]
    return {
        each.name: tuple(_within_reach(each.name, firmware if each.receivers else unread))
        for each in topics
        if _is_command(scan.app, each)
    }


def _is_command(app: AppFacts, command: Command) -> bool:
    """Return whether a topic of the inventory is known to command, not only to be told."""
    if (command.receivers and command.senders) or app.is_motion(command.name):
        return True
    is_left = command.senders and not (command.receivers or _is_sent_once(app, command))
    return bool(is_left) and any(_within_reach(command.name, NodeRoles(app).firmware))


def _is_sent_once(app: AppFacts, command: Command) -> bool:
    return bool(command.senders) and all(map(app.sends_once, command.senders))


def _open_inputs(app: AppFacts) -> frozenset[str]:
    """Return the inputs of arbiters that no node of the app sends."""
    inputs = chain.from_iterable(taken for taken, _ in arbiters(app).values())
    return frozenset(topic for topic in inputs if not app.publishers(topic))


def _within_reach(topic: str, nodes: Iterable[str]) -> Iterator[str]:
    """Yield the nodes of which the namespace is within that of a topic, or the other way round."""
    namespace = topic.rpartition("/")[0]
    return (node for node in nodes if are_nested(node.rpartition("/")[0], namespace))


def find_unguarded_commands(plan: Plan, scan: ScanResult | None = None) -> tuple[PlanProblem, ...]:
    """Return a warning for each thing whose last commands no coordination node enforces.

    Of a plan that guards nothing it says for all of the inventory why. Without a `scan` of the app
    only the commands that the plan observes are known.
    """
    if scan is None:
        moving = (stream for stream in build_streams(plan) if stream.is_command or stream.action)
        observed = {stream.topic for stream in moving if stream.mode is Mode.OBSERVE}
        return tuple(_warning(topic, _OBSERVED) for topic in sorted(observed))
    if guards_nothing(plan) and not scan.inventory:
        return (_warning(plan.app or "app", _NOTHING_MOVES),)
    return tuple(
        _warning(str(thing), f"{join_names(names)}: {why}")
        for thing, why, names in _unguarded(plan, scan)
    )


def unguarded_requests(plan: Plan, scan: ScanResult) -> tuple[UnguardedPath, ...]:
    """Return the services and actions that move the robot past the guard of a plan, and why."""
    last = (each for mover in scan.inventory for each in mover.last_commands)
    requests = {each.name for each in last if each.means in {Means.SERVICE, Means.ACTION}}
    found = {name: why for _, why, names in _unguarded(plan, scan) for name in names}
    return tuple(UnguardedPath(what=n, why=why) for n, why in found.items() if n in requests)


def _unguarded(plan: Plan, scan: ScanResult) -> Iterator[tuple[Thing, str, list[str]]]:
    """Yield the things that a plan does not guard whole: why, and of which commands."""
    modes = {stream.topic: stream.mode for stream in reversed(build_streams(plan))}
    for mover in scan.inventory:
        reasons = _reasons(scan.app, mover, modes, is_void=guards_nothing(plan))
        yield from ((mover.thing, why, names) for why, names in reasons.items())


def _reasons(
    app: AppFacts, mover: Mover, modes: Mapping[str, Mode], *, is_void: bool
) -> dict[str, list[str]]:
    """Return the names of commands that are not guarded, by why; an action is by its goals."""
    names: dict[str, list[str]] = defaultdict(list)
    for each in mover.last_commands if is_void else _to_be_guarded(mover):
        mode = _mode(each, modes)
        if each.means is Means.SERVICE or mode is not Mode.ENFORCE:
            names[_why(app, mover, each, mode)].append(each.name)
    for driver in () if mover.last_commands else mover.drivers:
        names[_UNCOMMANDED if mover.hardware else _why_unread(app, driver)].append(driver)
    for each in _passed_on(mover, modes):
        who = f"{join_names(each.receivers)} {conjugate(each.receivers, 'act')}"
        names[f"not guarded: {who} on what any node sends there"].append(each.name)
    return names


def _why_unread(app: AppFacts, driver: str) -> str:
    """Return why it is not known what a node obeys: its source is no part of the app, or is."""
    if driver in NodeRoles(app).firmware:
        return _FIRMWARE
    return _UNFOLLOWED if app.nodes[driver].trust is Trust.OWN else _UNREAD


def _passed_on(mover: Mover, modes: Mapping[str, Mode]) -> Iterator[Command]:
    """Yield the topics without a guard that those obey who may send what is guarded."""
    guarded = (c for c in mover.commands if _mode(c, modes) is Mode.ENFORCE)
    senders = {node for each in guarded for node in each.senders}
    for each in mover.commands:
        is_open = each.means is Means.TOPIC and modes.get(each.name) is not Mode.ENFORCE
        if is_open and each.hops and not senders.isdisjoint(each.receivers):
            yield each


def _mode(command: Command, modes: Mapping[str, Mode]) -> Mode | None:
    """Return how a plan guards a command, an action by its goals; None if it does not."""
    return modes.get(command.name) or modes.get(f"{command.name}/goal")


def _to_be_guarded(mover: Mover) -> Iterator[Command]:
    """Yield the last commands but parameters and the topics of stops: who wants to stop may."""
    for each in mover.last_commands:
        is_stop = mover.thing is Thing.STOP and each.means is Means.TOPIC
        if each.means is not Means.PARAMETER and not is_stop:
            yield each


def _why(app: AppFacts, mover: Mover, command: Command, mode: Mode | None) -> str:
    if mode and command.means is not Means.SERVICE:
        return _OBSERVED
    if command.means is not Means.TOPIC:
        return _WHY_UNGUARDED[command.means]
    if "{" in command.name:
        return "no plan can guard it: its whole name is not known"
    if mover.thing in NO_MOTION or command.type in SIGNALS:
        return _STOP if mover.thing is Thing.STOP else _SIGNAL
    if command.receivers and command.senders:
        return _WHY_UNGUARDED[Means.TOPIC]
    return _ONCE if _is_sent_once(app, command) else _missing_side(app, mover, command)


def _missing_side(app: AppFacts, mover: Mover, command: Command) -> str:
    """Return who is not known of a command: its senders, or who obeys it."""
    unread = [name for name in mover.unread if name.startswith("/")]
    if unread and not command.receivers:
        who = join_names(unread)
        if NodeRoles(app).firmware.issuperset(unread):
            return f"nobody that was read obeys it, and the firmware behind {who} may: {_LOOK}"
        return f"nobody that was read obeys it, and {who} may: give the source"
    missing = "sends" if command.receivers else "obeys"
    return f"nobody in this launch {missing} it: give the launch file of who should"


def _warning(where: str, why: str) -> PlanProblem:
    return PlanProblem(ProblemLevel.WARNING, where, why)


_STOP = "a plan leaves stops open: who stops the robot may be anyone"
_SIGNAL = "a plan leaves switches and signals open: any node can send it"
_ONCE = "sent once, and a guard keeps no command for later: guard it yourself, with `kind: state`"
_OBSERVED = "its coordination node only observes: `mode: enforce` guards it"
_NOTHING_MOVES = "nothing that was read moves a robot: give the launch file and source of what does"
_LOOK = "look at its subscriptions while the robot runs"
_FIRMWARE = f"what that firmware obeys is not known: {_LOOK}"
_UNCOMMANDED = "it decides itself, or obeys a device or link of its own: no topic leads there"
_UNREAD = "not read, so what moves it is not known: give its source"
_UNFOLLOWED = "read in part, so what moves it is not known: see what its scan does not resolve"
_WHY_UNGUARDED = {
    Means.TOPIC: "no coordination node enforces who commands it",
    Means.ACTION: "no coordination node enforces who sends its goals",
    Means.SERVICE: "a plan cannot guard services: whoever reaches it can call it",
    Means.PARAMETER: "a plan cannot guard parameters: any node can set them",
}

"""Several nodes command one motion.

## What it finds

A topic that commands motion (a velocity, a setpoint, a trajectory) has more than one publisher. The
base obeys whoever published last. A topic without a known reader counts, too, and so does a node
that publishes past an arbiter.

For example, `/move_base` and `/teleop` publish `/cmd_vel`; `/base_driver`, which was not read, may
obey.

## What to do

`rtron plan` proposes a GRCN before the readers, with a priority for each publisher. Or let every
publisher go through one arbiter.

## When it is silent

Among nodes of one stack, such as Nav2's servers, unless one passes the collision monitor by; for a
base that publishes its own input, and a `topic pub` of the launch that sends once. Requests such as
PX4's, and commands that reach nobody, are `pedantic`.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping

from rtron.findings.app_facts import AppFacts
from rtron.findings.lost_commands import lost_commands
from rtron.findings.node_kinds import arbiters, is_one_stack, moves
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel
from rtron.wording import both_or_all, conjugate, join_names

_REQUESTS = ("px4_msgs/VehicleCommand",)
_LIMITS = ("max_vel", "speed_limit", "velocity_limit")


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each set of nodes that command the same readers by the same topics."""
    known_arbiters, lost = arbiters(app), lost_commands(app)
    topics: dict[tuple[tuple[str, ...], tuple[str, ...]], list[str]] = defaultdict(list)
    for topic in app.motion_topics:
        publishers = senders(app, topic)
        if len(publishers) > 1 and not is_one_stack(app, publishers):
            topics[publishers, app.readers(topic)].append(topic)
    for (publishers, _), contended in topics.items():
        passed_by = arbiters_of(publishers, known_arbiters)
        is_harmless = _is_request(app, contended[0]) or contended[0] in lost
        yield _finding(app, contended, publishers, passed_by, is_harmless=is_harmless)


def senders(app: AppFacts, topic: str) -> tuple[str, ...]:
    """Return who commands by a topic: its publishers, without a base that may answer itself."""
    readers = app.readers(topic)
    publishers = tuple(node for node in app.publishers(topic) if not app.sends_once(node))
    others = tuple(node for node in publishers if node not in readers)
    return others if set(readers) <= set(publishers) else publishers


def arbiters_of(publishers: tuple[str, ...], known: Mapping[str, object]) -> list[str]:
    """Return the arbiters among publishers, multiplexers first: they have the priorities."""
    return sorted((n for n in publishers if n in known), key=lambda name: ("mux" not in name, name))


def _finding(
    app: AppFacts,
    topics: list[str],
    publishers: tuple[str, ...],
    passed_by: list[str],
    *,
    is_harmless: bool,
) -> Finding:
    """Return the finding; it is harmless where the commands are requests, or reach nobody."""
    readers, names = app.readers(topics[0]), join_names(topics)
    command = _command(app, topics[0])
    maybe_readers = () if readers else app.open_readers(topics[0])
    obedient = readers or maybe_readers
    who = join_names(obedient) if obedient else "the base"
    others = tuple(node for node in publishers if node not in passed_by)
    if passed_by and others:
        summary = f"{join_names(others)} can {command} on {names} past {passed_by[0]}"
        verb = f"{conjugate(readers, 'hear')} {both_or_all(publishers)}"
        cause = f"{passed_by[0]} stands before the robot, but {who} {verb}: what "
        cause += f"{join_names(others)} {conjugate(others, 'send')} does not pass it"
    else:
        summary = f"{join_names(publishers)} {both_or_all(publishers)} {command} on {names}"
        obeys = conjugate(obedient, "obey")
        cause = f"no arbiter stands between them: {who} {obeys} whoever published last"
    return make_finding(
        RULE.name,
        topics[0],
        summary=summary,
        cause=cause + ("" if readers else f"; {_missing_reader(app, maybe_readers)}"),
        remedy=f"put one arbiter before {names}: `rtron plan` proposes a guard (GRCN)",
        consequence=Consequence.MOTION,
        certainty=Certainty.CERTAIN if readers else Certainty.LIKELY,
        level=FindingLevel.PEDANTIC if is_harmless else None,
        only_own_nodes=app.facts.are_own(publishers),
        nodes=(*publishers, *readers),
        topics=topics,
        evidence=app.evidence(end for topic in topics for end in app.graph.publishers(topic)),
    )


def _is_request(app: AppFacts, topic: str) -> bool:
    """Return whether commands are done one by one."""
    return app.facts.topic(topic).type in _REQUESTS


def _command(app: AppFacts, topic: str) -> str:
    if app.is_stop(topic):
        return "set and release the emergency stop"
    is_limit = any(word in topic for word in _LIMITS)
    return "set the robot's speed limit" if is_limit else "drive the robot"


def _missing_reader(app: AppFacts, maybe_readers: tuple[str, ...]) -> str:
    if maybe_readers:
        return f"not all topics that {join_names(maybe_readers)} subscribes are known"
    bases = [node for node in app.unread_nodes if moves(node, app.nodes[node].package)]
    if not bases:
        return "its reader is not in the source"
    return f"its reader is not in the source, it may be {join_names(bases)} (not read)"


RULE = FindingRule(
    name="several_publishers",
    title="Several nodes command one motion",
    consequence="motion: certain where a reader is known, else likely",
    since="0.1.0",
    check=check,
)

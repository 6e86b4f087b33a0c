"""What could move the robot and is in no coordination node of a plan, and why."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

from rtron.findings.app_facts import AppFacts
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.planning.proposal.policy_defaults import unguardable_topics
from rtron.vocabulary import GRCN, Domain, GuardedTopic, Mode, Plan, build_streams
from rtron.vocabulary.inventory import NO_MOTION, SIGNALS, Command, Means, Mover, Thing
from rtron.wording import join_names
from rtron.workflows.scan import ScanResult

_MOVING = (Domain.PLANNING, Domain.CONTROL)


def unguarded_topics(plan: Plan, scan: ScanResult | None = None) -> tuple[PlanProblem, ...]:
    """Return a warning for each topic that could move the robot, of a plan that guards nothing.

    The `scan` adds the topics of the app that the plan does not have.
    """
    problems = {each.location: each for each in (*_planned(plan), *_of_app(scan))}
    omitted = unguardable_topics(scan.graph, scan.report) if scan else ()
    problems |= {each.location: each for each in omitted}
    return tuple(problems[location] for location in sorted(problems))


def last_command_topics(movers: Iterable[Mover], app: AppFacts) -> frozenset[str]:
    """Return the topics that nodes next to the hardware obey.

    Switches, limits and mere signals are not among them: a stop, a reset or an order to land must
    come from anyone. Where nobody in the app sends one, its type and name must say that it commands
    motion: a driver hears measurements, too.
    """
    moving = (mover for mover in movers if mover.thing not in NO_MOTION)
    commands = (each for mover in moving for each in mover.last_commands)
    topics = (c for c in commands if c.means is Means.TOPIC and c.type not in SIGNALS)
    return frozenset(
        each.name
        for each in topics
        if each.receivers and (each.senders or app.is_motion(each.name))
    )


def unguarded_commands(
    plan: Plan, movers: Iterable[Mover], kinds: Collection[Means] = tuple(Means)
) -> tuple[PlanProblem, ...]:
    """Return a warning for each thing whose last commands no coordination node enforces."""
    guarded = {stream.topic for stream in build_streams(plan) if stream.mode is Mode.ENFORCE}
    return tuple(
        PlanProblem(ProblemLevel.WARNING, str(mover.thing), f"{join_names(names)}: {why}")
        for mover in movers
        for why, names in _left(_not_left_open(mover), kinds, guarded).items()
    )


def _not_left_open(mover: Mover) -> Iterator[Command]:
    """Yield the last commands but the topics of stops: who wants to stop the robot may."""
    for each in mover.last_commands:
        if not (mover.thing is Thing.STOP and each.means is Means.TOPIC):
            yield each


def _left(
    commands: Iterable[Command], kinds: Collection[Means], guarded: Collection[str]
) -> dict[str, list[str]]:
    """Return the names of commands that are not guarded, by why; an action is by its goals."""
    names: dict[str, list[str]] = defaultdict(list)
    for each in commands:
        goals = f"{each.name}/goal" if each.means is Means.ACTION else each.name
        is_guarded = each.means is not Means.SERVICE and not {each.name, goals}.isdisjoint(guarded)
        if each.means in kinds and each.means in _WHY_UNGUARDED and not is_guarded:
            names[_why(each)].append(each.name)
    return names


def _why(command: Command) -> str:
    if command.means is Means.TOPIC and not command.receivers:
        return "what obeys it is not in this launch: give its launch file too"
    if command.means is Means.TOPIC and not command.senders:
        return (
            "nobody in this launch sends it, but any node can: give the launch file of who should"
        )
    return _WHY_UNGUARDED[command.means]


_WHY_UNGUARDED = {
    Means.TOPIC: "no coordination node enforces who commands it",
    Means.ACTION: "no coordination node enforces who sends its goals",
    Means.SERVICE: "a plan cannot guard services: whoever reaches it can call it",
}


def _planned(plan: Plan) -> Iterator[PlanProblem]:
    parts: Iterable[GRCN | GuardedTopic] = (
        *(grcn for grcn in plan.grcn if grcn.domain in _MOVING),
        *(plan.rsrcn.vflows if plan.rsrcn else ()),
        *(plan.msrcn.aflows if plan.msrcn else ()),
    )
    for part in parts:
        yield _unguarded(part.topic, [flow.publisher for flow in part.flows], part.successors)


def _of_app(scan: ScanResult | None) -> Iterator[PlanProblem]:
    if scan:
        for topic in scan.app.motion_topics:
            yield _unguarded(topic, scan.app.publishers(topic), scan.app.readers(topic))


def _unguarded(topic: str, publishers: Sequence[str], readers: Sequence[str]) -> PlanProblem:
    why = "its coordination node only observes: `mode: enforce` guards it"
    if "{" in topic:
        why = "cannot be guarded: its name is not known"
    elif not publishers:
        why = "no node is known to publish it: give the launch file of who should"
    elif not readers:
        why = "no node is known to subscribe it: give the launch file of what obeys it"
    elif len(publishers) == 1:
        why = f"only {publishers[0]} publishes it: `mode: enforce` keeps every other node out"
    return PlanProblem(ProblemLevel.WARNING, topic, why)

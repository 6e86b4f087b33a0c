"""Whether the MSRCN's eflows, rules, areas and transforms agree, their expressions apart."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain, islice

from rtron.coherence.flows import (
    CoherenceProblem,
    duplicates,
    guarded_topic_problems,
    policy_problems,
)
from rtron.coherence.polygons import polygon_problem
from rtron.coherence.required_flows import required_flow_problems
from rtron.coherence.settings_bounds import MAX_RULES
from rtron.errors import suggestion
from rtron.vocabulary import (
    MSRCN,
    Area,
    EventFlow,
    MissionRule,
    PolicyName,
    Transform,
    normalise_type,
)

MAX_AREAS = 100
MAX_EXPRESSIONS = 200
MAX_EFLOWS = 1000
# More faults of rules than this help nobody, and each costs a search for the nearest word.
_MAX_REPORTED = 100
POLICIES = (PolicyName.BLOCK,)
# What an expression calls the message that it is about, and its functions.
RESERVED_WORDS = ("event", "action", "inside", "distance", "place")


def msrcn_problems(msrcn: MSRCN) -> Iterator[CoherenceProblem]:
    """Yield everything in which the MSRCN contradicts itself."""
    yield from msrcn_policy_problems(msrcn)
    yield from guarded_topic_problems(msrcn.aflows, msrcn.eflows)
    guarded = {topic.topic for topic in msrcn.aflows}
    for flow in msrcn.eflows:
        yield from _eflow(flow, guarded)
    if len(msrcn.eflows) > MAX_EFLOWS:
        yield msrcn.eflows[MAX_EFLOWS], "", f"more than {MAX_EFLOWS} eflows"
    for flow in [flow for flow in msrcn.eflows if flow.when][MAX_EXPRESSIONS:]:
        yield flow, "when", f"more than {MAX_EXPRESSIONS} eflows with an expression"
    yield from _areas(msrcn)
    yield from _transforms(msrcn.transforms)


def msrcn_policy_problems(msrcn: MSRCN) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with the policy of the MSRCN and its rules."""
    yield from policy_problems(msrcn, "the MSRCN", msrcn.policy, POLICIES)
    yield from _rules(msrcn)


def _eflow(flow: EventFlow, guarded: set[str]) -> Iterator[CoherenceProblem]:
    if flow.present is not None and flow.silent is not None:
        yield flow, "silent", "an eflow has `present` or `silent`, not both: make two of it"
    elif not flow.when and flow.present is None and flow.silent is None:
        yield flow, "", "what sets the bit of this eflow? It needs `when`, `present` or `silent`"
    if flow.topic in guarded:
        why = "a topic that the MSRCN blocks is no event"
        yield flow, "topic", f"{flow.topic} is an aflow's: {why}; use the rule's `action`"


def _areas(msrcn: MSRCN) -> Iterator[CoherenceProblem]:
    flows = [flow.name for topic in msrcn.aflows for flow in topic.flows]
    taken = {*flows, *(flow.name for flow in msrcn.eflows)}
    for area in duplicates(msrcn.areas, lambda area: area.name):
        yield area, "name", f"two areas have the name {area.name}"
    for area in msrcn.areas[:MAX_AREAS]:
        yield from _area(area, taken)
    if len(msrcn.areas) > MAX_AREAS:
        yield msrcn.areas[MAX_AREAS], "", f"more than {MAX_AREAS} areas"


def _area(area: Area, taken: set[str]) -> Iterator[CoherenceProblem]:
    if area.name in taken:
        yield area, "name", f"{area.name} is the name of a flow, too"
    if area.name in RESERVED_WORDS:
        yield area, "name", f"{area.name} means something else in expressions: choose another name"
    problem = polygon_problem(area.polygon)
    if problem:
        yield area, "polygon", problem


def _transforms(transforms: Sequence[Transform]) -> Iterator[CoherenceProblem]:
    for one in transforms:
        if len(_frames(one)) == 1:
            yield one, "target", f"a transform from {one.source} to itself"
    for one in duplicates(transforms, _frames):
        yield one, "", f"two transforms between {one.source} and {one.target}"


def _frames(transform: Transform) -> frozenset[str]:
    return frozenset(frame.removeprefix("/") for frame in (transform.source, transform.target))


def _rules(msrcn: MSRCN) -> Iterator[CoherenceProblem]:
    for rule in duplicates(msrcn.rules, lambda rule: rule.name):
        yield rule, "name", f"two rules have the name {rule.name}"
    if len(msrcn.rules) > MAX_RULES:
        yield msrcn.rules[MAX_RULES], "", f"more than {MAX_RULES} rules"
    actions = flows_by_name(msrcn)
    eflows = msrcn.eflows[:MAX_EFLOWS]
    problems = (
        chain(
            _blocked(rule, actions),
            required_flow_problems(rule, actions, eflows),
            _one_type(rule, msrcn),
        )
        for rule in msrcn.rules[:MAX_RULES]
    )
    yield from islice(chain.from_iterable(problems), _MAX_REPORTED)


def _blocked(
    rule: MissionRule, actions: Mapping[str, frozenset[str]]
) -> Iterator[CoherenceProblem]:
    if not rule.block:
        yield rule, "block", "a rule blocks at least one aflow or topic"
    for name in rule.block:
        if name not in actions:
            yield (
                rule,
                "block",
                f"no aflow or topic {name} in the MSRCN: {_suggestion(name, actions)}",
            )


def flows_by_name(msrcn: MSRCN) -> dict[str, frozenset[str]]:
    """Return what a rule can block, a topic or an aflow, each with the names of its aflows."""
    topics = {topic.topic: frozenset(flow.name for flow in topic.flows) for topic in msrcn.aflows}
    return topics | {name: frozenset({name}) for names in topics.values() for name in names}


def blocked_types(rule: MissionRule, msrcn: MSRCN) -> set[str]:
    """Return the message types, as ROS 1 spells them, of the topics that a rule blocks."""
    return {
        normalise_type(topic.type)
        for topic in msrcn.aflows
        if topic.topic in rule.block or any(flow.name in rule.block for flow in topic.flows)
    }


def _one_type(rule: MissionRule, msrcn: MSRCN) -> Iterator[CoherenceProblem]:
    types = blocked_types(rule, msrcn) if rule.action else set()
    if len(types) > 1:
        type_names = ", ".join(sorted(name or "one that is not given" for name in types))
        yield (
            rule,
            "action",
            f"the blocked topics have different types ({type_names}): make two rules",
        )
    elif types == {""}:
        yield rule, "action", "the type of the blocked topic is needed: give the aflow's `type`"


def _suggestion(name: str, known: Collection[str]) -> str:
    return suggestion(name, sorted(known)) if known else "it has none"

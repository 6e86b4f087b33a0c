"""Whether the MSRCN's eflows, rules, areas and transforms agree, their expressions apart."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain, islice

from rtron.planning.coherence.flows import Misfit, guarded_misfits, policy_misfit, repeated
from rtron.planning.coherence.polygons import polygon_misfit
from rtron.planning.coherence.required_flows import required_misfits
from rtron.planning.plan_file.problems import suggestion
from rtron.vocabulary import MSRCN, Area, EventFlow, PolicyName, Rule, Transform, normalise_type

MOST_AREAS = 100
MOST_RULES = MOST_EXPRESSIONS = 200
MOST_EFLOWS = 1000
# More faults of rules than this help nobody, and each costs a search for the nearest word.
_MOST_TOLD = 100
POLICIES = (PolicyName.BLOCK,)
# What an expression calls the message that it is about, and its functions.
TAKEN = ("event", "action", "inside", "distance", "place")


def msrcn_misfits(msrcn: MSRCN) -> Iterator[Misfit]:
    """Yield everything in which the MSRCN contradicts itself."""
    yield from policy_misfit(msrcn, "the MSRCN", msrcn.policy, POLICIES)
    yield from guarded_misfits(msrcn.aflows, msrcn.eflows)
    guarded = {topic.topic for topic in msrcn.aflows}
    for flow in msrcn.eflows:
        yield from _eflow(flow, guarded)
    if len(msrcn.eflows) > MOST_EFLOWS:
        yield msrcn.eflows[MOST_EFLOWS], "", f"more than {MOST_EFLOWS} eflows"
    for flow in [flow for flow in msrcn.eflows if flow.when][MOST_EXPRESSIONS:]:
        yield flow, "when", f"more than {MOST_EXPRESSIONS} eflows with an expression"
    yield from _areas(msrcn)
    yield from _transforms(msrcn.transforms)
    yield from _rules(msrcn)


def _eflow(flow: EventFlow, guarded: set[str]) -> Iterator[Misfit]:
    if flow.present is not None and flow.silent is not None:
        yield flow, "silent", "an eflow has `present` or `silent`, not both: make two of it"
    elif not flow.when and flow.present is None and flow.silent is None:
        yield flow, "", "what sets the bit of this eflow? It needs `when`, `present` or `silent`"
    if flow.topic in guarded:
        why = "a topic that the MSRCN blocks is no event"
        yield flow, "topic", f"{flow.topic} is an aflow's: {why}; use the rule's `action`"


def _areas(msrcn: MSRCN) -> Iterator[Misfit]:
    flows = [flow.name for topic in msrcn.aflows for flow in topic.flows]
    taken = {*flows, *(flow.name for flow in msrcn.eflows)}
    for area in repeated(msrcn.areas, lambda area: area.name):
        yield area, "name", f"two areas have the name {area.name}"
    for area in msrcn.areas[:MOST_AREAS]:
        yield from _area(area, taken)
    if len(msrcn.areas) > MOST_AREAS:
        yield msrcn.areas[MOST_AREAS], "", f"more than {MOST_AREAS} areas"


def _area(area: Area, taken: set[str]) -> Iterator[Misfit]:
    if area.name in taken:
        yield area, "name", f"{area.name} is the name of a flow, too"
    if area.name in TAKEN:
        yield area, "name", f"{area.name} means something else in expressions: choose another name"
    fault = polygon_misfit(area.polygon)
    if fault:
        yield area, "polygon", fault


def _transforms(transforms: Sequence[Transform]) -> Iterator[Misfit]:
    for one in transforms:
        if len(_ends(one)) == 1:
            yield one, "target", f"a transform from {one.source} to itself"
    for one in repeated(transforms, _ends):
        yield one, "", f"two transforms between {one.source} and {one.target}"


def _ends(transform: Transform) -> frozenset[str]:
    return frozenset(frame.removeprefix("/") for frame in (transform.source, transform.target))


def _rules(msrcn: MSRCN) -> Iterator[Misfit]:
    for rule in repeated(msrcn.rules, lambda rule: rule.name):
        yield rule, "name", f"two rules have the name {rule.name}"
    if len(msrcn.rules) > MOST_RULES:
        yield msrcn.rules[MOST_RULES], "", f"more than {MOST_RULES} rules"
    actions = flows_by_name(msrcn)
    eflows = msrcn.eflows[:MOST_EFLOWS]
    found = (
        chain(
            _blocked(rule, actions),
            required_misfits(rule, actions, eflows),
            _one_type(rule, msrcn),
        )
        for rule in msrcn.rules[:MOST_RULES]
    )
    yield from islice(chain.from_iterable(found), _MOST_TOLD)


def _blocked(rule: Rule, actions: Mapping[str, frozenset[str]]) -> Iterator[Misfit]:
    if not rule.block:
        yield rule, "block", "a rule blocks at least one aflow or topic"
    for name in rule.block:
        if name not in actions:
            yield rule, "block", f"no aflow or topic {name} in the MSRCN: {_near(name, actions)}"


def flows_by_name(msrcn: MSRCN) -> dict[str, frozenset[str]]:
    """Return what a rule can block, a topic or an aflow, each with the names of its aflows."""
    topics = {topic.topic: frozenset(flow.name for flow in topic.flows) for topic in msrcn.aflows}
    return topics | {name: frozenset({name}) for names in topics.values() for name in names}


def blocked_types(rule: Rule, msrcn: MSRCN) -> set[str]:
    """Return the message types, as ROS 1 spells them, of the topics that a rule blocks."""
    return {
        normalise_type(topic.type)
        for topic in msrcn.aflows
        if topic.topic in rule.block or any(flow.name in rule.block for flow in topic.flows)
    }


def _one_type(rule: Rule, msrcn: MSRCN) -> Iterator[Misfit]:
    types = blocked_types(rule, msrcn) if rule.action else set()
    if len(types) > 1:
        told = ", ".join(sorted(name or "one that is not given" for name in types))
        yield rule, "action", f"the blocked topics have different types ({told}): make two rules"
    elif types == {""}:
        yield rule, "action", "the type of the blocked topic is needed: give the aflow's `type`"


def _near(name: str, known: Collection[str]) -> str:
    return suggestion(name, sorted(known)) if known else "it has none"

"""What may be meant in a mission although it looks odd.

Rules that whom they block can lift, events that are too costly to judge, expressions that always
hold.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import product

from rtron.messages.expressions.python_terms import MAX_ROUNDS, macro_depth
from rtron.planning.expressions import check_expressions
from rtron.planning.problem import ProblemLevel
from rtron.planning.protection_gaps import Gap, matches_every_node
from rtron.planning.rule_contradictions import BitCondition
from rtron.vocabulary import EventFlow, MissionRule, Mode, Plan, WhenUnknown, patterns_overlap
from rtron.wording import join_names

_COUNTED = {WhenUnknown.SET: True, WhenUnknown.CLEAR: False}
_MOST_EVENTS = 6
"""Of so many it is tried what their bits do; of more it may be missed."""
_UNUSUAL_DEPTH = 3


def mission_warnings(plan: Plan) -> Iterator[Gap]:
    """Yield what is odd in the mission of a plan without errors: the rule or eflow, and what."""
    checked = check_expressions(plan)
    for level, rule, message in checked.contradictions:
        if level is ProblemLevel.WARNING:
            yield f"rule {rule.name}", message
    yield from _gaps(plan, checked.conditions)
    for part in checked.always:
        if isinstance(part, EventFlow):
            help = "leave `when` out, and say with `present` how long a message counts"
            yield f"eflow {part.name}", f"`when` holds for every message of {part.topic}: {help}"
        else:
            yield f"rule {part.name}", "`action` holds for every message: leave it out"


def _gaps(plan: Plan, conditions: Mapping[str, BitCondition]) -> Iterator[Gap]:
    """Yield the rules that do not hold when they should."""
    msrcn = plan.msrcn
    if msrcn is None or msrcn.mode is not Mode.ENFORCE:
        return
    for rule in msrcn.rules:
        condition = conditions.get(rule.name)
        if condition is not None and condition.names:
            events = [flow for flow in msrcn.eflows if flow.name in condition.names]
            yield from ((f"rule {rule.name}", each) for each in _lapses(condition, events))
            own = _events_of_blocked(plan, rule, events)
            if own and _can_lift(condition, own):
                yield f"rule {rule.name}", _lifted_by(own)
    for flow in msrcn.eflows:
        if matches_every_node(flow.publisher):
            where = f"eflow {flow.name}"
            yield where, f"every node can publish {flow.topic} as {flow.publisher}: name one"
    texts = [(f"eflow {flow.name}", "when", flow.when) for flow in msrcn.eflows]
    texts += [(f"rule {rule.name}", "action", rule.action) for rule in msrcn.rules]
    for where, key, text in texts:
        yield from ((where, message) for message in _costly(key, text))


def _lapses(condition: BitCondition, events: Iterable[EventFlow]) -> Iterator[str]:
    """Yield that a rule does not hold while its events are unknown, if the plan says so."""
    for key, cause in (("on_silence", "is silent"), ("on_error", "says what cannot be judged")):
        bits = {
            flow.name: _COUNTED[value]
            for flow in events
            if (value := getattr(flow, key)) in _COUNTED
        }
        if bits and condition.holds(bits) is False:
            who = join_names(sorted({flow.publisher for flow in events if flow.name in bits}))
            yield f"while {who} {cause}, this blocks nothing: leave `{key}` out, then it blocks"


def _events_of_blocked(
    plan: Plan, rule: MissionRule, events: Iterable[EventFlow]
) -> list[EventFlow]:
    """Return the events that come from a node which the rule blocks."""
    blocked = set(_blocked_publishers(plan, rule))
    return [
        flow
        for flow in events
        if any(patterns_overlap(flow.publisher, publisher) for publisher in blocked)
    ]


def _blocked_publishers(plan: Plan, rule: MissionRule) -> Iterator[str]:
    for topic in plan.msrcn.aflows if plan.msrcn else ():
        is_blocked = topic.topic in rule.block
        yield from (f.publisher for f in topic.flows if is_blocked or f.name in rule.block)
        for grcn in plan.grcn if is_blocked else ():
            if grcn.topic == topic.topic:
                yield from (flow.publisher for flow in grcn.flows)


def _can_lift(condition: BitCondition, own: list[EventFlow]) -> bool:
    names = [flow.name for flow in own[:_MOST_EVENTS]]
    cases = product((False, True), repeat=len(names))
    return any(condition.holds(dict(zip(names, case, strict=True))) is False for case in cases)


def _lifted_by(own: list[EventFlow]) -> str:
    who = join_names(sorted({flow.publisher for flow in own}))
    events = join_names([flow.name for flow in own])
    return f"{events} comes from {who}, which this blocks: it can lift its own block; ask another"


def _costly(key: str, text: str) -> Iterator[str]:
    depth = macro_depth(text)
    if depth >= _UNUSUAL_DEPTH:
        longest = round(MAX_ROUNDS ** (1 / depth))
        what = f"of a list of over {longest} elements that takes more than {MAX_ROUNDS} rounds"
        yield f"`{key}` goes over lists {depth} deep: {what}, and then it cannot be judged"

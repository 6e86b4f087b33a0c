"""Whether the MSRCN's eflows, rules, areas and transforms agree, their expressions apart."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain, combinations, islice

from rtron.coherence.duration_bounds import MAX_RULES
from rtron.coherence.flows import (
    CoherenceProblem,
    duplicates,
    guarded_topic_problems,
    policy_problems,
    required_flow_problems,
)
from rtron.errors import suggestion
from rtron.vocabulary import (
    MSRCN,
    Area,
    EventFlow,
    MissionRule,
    Point,
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


MIN_CORNERS = 3
MAX_CORNERS = 100
_GRID = 1_000_000
_SQUARE_MILLIMETRE = 1_000_000
_Corner = tuple[int, int]
_Edge = tuple[_Corner, _Corner]


def polygon_problem(points: Sequence[Point]) -> str:
    """Return what keeps corners, in their order, from being an area; an empty text if nothing."""
    if not MIN_CORNERS <= len(points) <= MAX_CORNERS:
        return f"an area has {MIN_CORNERS} to {MAX_CORNERS} corners"
    corners = [(round(point.x * _GRID), round(point.y * _GRID)) for point in points]
    return _repeated(corners) or _misshapen(corners)


def _repeated(corners: Sequence[_Corner]) -> str:
    if corners[0] == corners[-1]:
        return "the last corner is the first one: leave it out"
    return "a corner stands there twice" if len(set(corners)) < len(corners) else ""


def _misshapen(corners: Sequence[_Corner]) -> str:
    if not any(_cross(corners[0], corners[1], corner) for corner in corners):
        return "the corners lie on one line"
    crossing = _crossing(corners)
    if crossing:
        return "the edges from corner {} and from corner {} cross".format(*crossing)
    small = abs(_doubled_area(corners)) < 2 * _SQUARE_MILLIMETRE
    return "the area is smaller than a square millimetre" if small else ""


def _doubled_area(corners: Sequence[_Corner]) -> int:
    return sum(_cross((0, 0), one, other) for one, other in _edges(corners))


def _edges(corners: Sequence[_Corner]) -> list[_Edge]:
    return list(zip(corners, [*corners[1:], corners[0]], strict=True))


def _crossing(corners: Sequence[_Corner]) -> tuple[int, int] | None:
    """Return the numbers, from 1, of two edges that meet where they should not."""
    edges = list(enumerate(_edges(corners), start=1))
    for (first, one), (second, other) in combinations(edges, 2):
        if _meet(one, other):
            return first, second
    return None


def _meet(one: _Edge, other: _Edge) -> bool:
    (a, b), (c, d) = one, other
    if b == c:
        return _folds(a, b, d)
    if a == d:
        return _folds(c, a, b)
    if not _boxes_meet(one, other):
        return False
    sides = _side(a, b, c) * _side(a, b, d), _side(c, d, a) * _side(c, d, b)
    return max(sides) <= 0


def _folds(before: _Corner, corner: _Corner, after: _Corner) -> bool:
    """Tell whether an edge goes back along the one before it."""
    (x, y), (p, q), (r, s) = corner, before, after
    return _cross(corner, before, after) == 0 and (p - x) * (r - x) + (q - y) * (s - y) > 0


def _boxes_meet(one: _Edge, other: _Edge) -> bool:
    return all(
        min(a, b) <= max(c, d) and min(c, d) <= max(a, b)
        for a, b, c, d in zip(*one, *other, strict=True)
    )


def _side(a: _Corner, b: _Corner, c: _Corner) -> int:
    turn = _cross(a, b, c)
    return (turn > 0) - (turn < 0)


def _cross(origin: _Corner, one: _Corner, other: _Corner) -> int:
    return (one[0] - origin[0]) * (other[1] - origin[1]) - (one[1] - origin[1]) * (
        other[0] - origin[0]
    )

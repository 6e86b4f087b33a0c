"""What holds for the flows and policies of every coordination node."""

from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from itertools import product
from typing import TypeVar

from rtron.errors import suggestion
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    UNAPPROVED,
    EventFlow,
    Flow,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    PolicyName,
    StreamKind,
    WatchedFlow,
    build_streams,
    is_guard_name,
    matches_node,
    normalise_type,
)

T = TypeVar("T")
CoherenceProblem = tuple[object, str, str]
"""A noun, its key (or an empty text for the whole) and what is wrong with it."""

_TWISTS = ("geometry_msgs/Twist", "geometry_msgs/TwistStamped")
# The private topics of a guarded topic end in a flow's name, or in `out`.
RESERVED_FLOW_NAMES = (UNAPPROVED, "out")
MAX_FLOWS = 1000


def guards_nothing(plan: Plan) -> bool:
    """Return whether no coordination node of a plan stands in a flow."""
    return all(stream.mode is not Mode.ENFORCE for stream in build_streams(plan))


def duplicate_topic_problems(
    guarded: Sequence[GRCN | GuardedTopic], who: str
) -> Iterator[CoherenceProblem]:
    """Yield each noun on a topic that an earlier one has already."""
    for part in duplicates(guarded, lambda part: part.topic):
        yield part, "topic", f"two {who} on {part.topic}"


def guarded_topic_problems(
    topics: Sequence[GuardedTopic], watched: Sequence[WatchedFlow | EventFlow]
) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with the flows of an RSRCN or MSRCN."""
    yield from duplicate_topic_problems(topics, "entries")
    yield from flow_name_problems([*(flow for topic in topics for flow in topic.flows), *watched])
    for topic in topics:
        yield from publisher_problems(topic.flows)
        yield from successor_problems(topic)
        yield from used_component_problems(topic)


def policy_problems(
    part: GRCN | RSRCN | MSRCN, who: str, policy: PolicyName, allowed: Iterable[PolicyName]
) -> Iterator[CoherenceProblem]:
    """Refuse a policy that is for other coordination nodes."""
    if policy not in allowed:
        yield part, "policy", f"{policy} is not for {who}: choose from {', '.join(allowed)}"


def flow_name_problems(
    flows: Sequence[Flow | WatchedFlow | EventFlow],
) -> Iterator[CoherenceProblem]:
    """Refuse names that repeat, and those that the guard uses itself."""
    for flow in duplicates(flows, lambda flow: flow.name):
        yield flow, "name", f"two flows have the name {flow.name}"
    for flow in flows:
        if flow.name in RESERVED_FLOW_NAMES:
            yield flow, "name", f"{flow.name} is the guard's own: choose another name"


def publisher_problems(flows: Sequence[Flow]) -> Iterator[CoherenceProblem]:
    """Refuse a publisher that belongs to two flows of one topic, and the guard as one."""
    for flow in flows:
        if is_guard_name(flow.publisher):
            yield flow, "publisher", f"{flow.publisher} is the guard's own: name a node of the app"
    for flow in duplicates(flows, lambda flow: flow.publisher):
        yield flow, "publisher", f"{flow.publisher} has two flows: which one would it take?"
    if len(flows) > MAX_FLOWS:
        yield flows[MAX_FLOWS], "", f"more than {MAX_FLOWS} flows into one topic"
        return
    patterns = [flow for flow in flows if "*" in flow.publisher]
    for pattern, flow in product(patterns, flows):
        if pattern.publisher != flow.publisher and matches_node(pattern.publisher, flow.publisher):
            both = f"{pattern.name} ({pattern.publisher}) too"
            yield flow, "publisher", f"{flow.publisher} belongs to {both}"


def successor_problems(part: GRCN | GuardedTopic) -> Iterator[CoherenceProblem]:
    """Refuse more successors than can be compared with each other."""
    if len(part.successors) > MAX_FLOWS:
        yield part, "successors", f"more than {MAX_FLOWS} successors of one topic"


def used_component_problems(part: GRCN | GuardedTopic) -> Iterator[CoherenceProblem]:
    """Refuse components of what has none: only the commands of a Twist have them."""
    if not part.uses:
        return
    if part.type and normalise_type(part.type) not in _TWISTS:
        yield part, "uses", f"a {part.type} has no {part.uses[0]}: `uses` is for a Twist"
    elif isinstance(part, GRCN) and part.kind is not StreamKind.COMMAND:
        yield part, "uses", f"`uses` is for commands, and {part.topic} has none"


def priority_problems(flows: Sequence[Flow], policy: PolicyName) -> Iterator[CoherenceProblem]:
    """Refuse a priority that an earlier flow has already."""
    for flow in duplicates(flows, lambda flow: flow.priority):
        who = next(f.name for f in flows if f.priority == flow.priority)
        message = f"{who} and {flow.name} have the same priority {flow.priority}"
        yield flow, "priority", f"{message}: who goes first with {policy}?"


def duplicates(parts: Iterable[T], key: Callable[[T], Hashable]) -> Iterator[T]:
    """Yield each noun whose key an earlier one has already."""
    seen: set[Hashable] = set()
    for part in parts:
        if key(part) in seen:
            yield part
        seen.add(key(part))


def required_flow_problems(
    rule: MissionRule, actions: Mapping[str, frozenset[str]], eflows: Sequence[EventFlow]
) -> Iterator[CoherenceProblem]:
    """Yield what is wrong with what a rule requires; `actions` are aflows by flow and topic."""
    name = rule.require
    if not name:
        return
    known = [*actions, *(name for flow in eflows for name in (flow.name, flow.topic))]
    if name not in known:
        near = suggestion(name, sorted(set(known))) if known else "it has none"
        yield rule, "require", f"no flow or topic {name} in the MSRCN: {near}"
    blocked = frozenset[str]().union(*(actions.get(other, ()) for other in rule.block))
    needed = actions.get(name)
    if name in rule.block or (needed and needed <= blocked):
        yield rule, "require", f"the rule itself blocks {name}, so it could never end"
    for flow in eflows:
        if flow.name == name and flow.silent is not None:
            why = "a silence does not speak"
            yield rule, "require", f"{name} is the eflow of a silence, and {why}: name its topic"


def self_fulfilling_problems(
    rule: MissionRule, event_names: Collection[str], eflows: Sequence[EventFlow]
) -> Iterator[CoherenceProblem]:
    """Refuse what is required if the rule's `when`, which asks for these eflows, hangs on it."""
    matching = [
        flow.name
        for flow in eflows
        if flow.name in event_names and rule.require in (flow.name, flow.topic)
    ]
    if matching:
        what = matching[0] if matching[0] == rule.require else f"{matching[0]} on {rule.require}"
        why = "what makes the rule hold cannot be what it requires"
        yield rule, "require", f"`when` names {what}: {why}; require another flow"

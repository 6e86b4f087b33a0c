"""Whether what a rule requires can end its block, and only once the rule holds."""

from collections.abc import Collection, Iterator, Mapping, Sequence

from rtron.coherence.flows import CoherenceProblem
from rtron.errors import suggestion
from rtron.vocabulary import EventFlow, MissionRule


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

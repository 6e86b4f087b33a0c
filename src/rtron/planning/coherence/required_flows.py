"""Whether what a rule requires can end its block, and only once the rule holds."""

from collections.abc import Collection, Iterator, Mapping, Sequence

from rtron.planning.coherence.flows import Misfit
from rtron.planning.plan_file.problems import suggestion
from rtron.vocabulary import EventFlow, Rule


def required_misfits(
    rule: Rule, actions: Mapping[str, frozenset[str]], eflows: Sequence[EventFlow]
) -> Iterator[Misfit]:
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


def self_met(rule: Rule, asked: Collection[str], eflows: Sequence[EventFlow]) -> Iterator[Misfit]:
    """Refuse what is required if the rule's `when`, which asks for these eflows, hangs on it."""
    own = [
        flow.name
        for flow in eflows
        if flow.name in asked and rule.require in (flow.name, flow.topic)
    ]
    if own:
        what = own[0] if own[0] == rule.require else f"{own[0]} on {rule.require}"
        why = "what makes the rule hold cannot be what it requires"
        yield rule, "require", f"`when` names {what}: {why}; require another flow"

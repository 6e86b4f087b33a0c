"""From a plan and settings to the plan in force; what does not fit is told, never guessed."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import fields, replace
from difflib import get_close_matches
from typing import Any, TypeVar

from rtron.vocabulary.plan import GRCN, MSRCN, RSRCN, Flow, GuardedTopic, Plan, Rule
from rtron.vocabulary.settings import FlowSettings, NodeSettings, RuleSettings, Settings

N = TypeVar("N", GRCN, RSRCN, MSRCN)
_SHOWN = 80


class MisfitError(Exception):
    """Settings name what the plan does not have; the text says what."""


def effective(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force, with the revision of the settings; MisfitError if they do not fit.

    Overrides and the emergency stop are not part of it: they change no policy.
    """
    left = dict(settings.nodes)
    grcn = tuple(_changed(node, left, _grcn) for node in plan.grcn)
    rsrcn = _changed(plan.rsrcn, left, _rsrcn) if plan.rsrcn else None
    msrcn = _changed(plan.msrcn, left, _msrcn) if plan.msrcn else None
    _refuse(left, "coordination node", coordination_ids(plan))
    return replace(plan, grcn=grcn, rsrcn=rsrcn, msrcn=msrcn, revision=settings.revision)


def fitting(plan: Plan, settings: Settings) -> tuple[Settings, tuple[str, ...]]:
    """Return the settings without what the plan does not have, and what was left out."""
    misfits = {id: _misfit(plan, Settings(nodes={id: settings.nodes[id]})) for id in settings.nodes}
    nodes = {id: node for id, node in settings.nodes.items() if not misfits[id]}
    known = {node.id for node in (plan.rsrcn, plan.msrcn) if node}
    overrides = {id: each for id, each in settings.overrides.items() if id in known}
    lost = [*filter(None, misfits.values())]
    lost += [f"{id} has an override" for id in settings.overrides if id not in known]
    return replace(settings, nodes=nodes, overrides=overrides), tuple(lost)


def coordination_ids(plan: Plan) -> tuple[str, ...]:
    """Return the ids of the coordination nodes that have a policy, in the plan's order."""
    return tuple(node.id for node in (*plan.grcn, plan.rsrcn, plan.msrcn) if node)


def _misfit(plan: Plan, settings: Settings) -> str:
    try:
        effective(plan, settings)
    except MisfitError as error:
        return str(error)
    return ""


def _changed(node: N, left: dict[str, NodeSettings], change: Callable[[N, NodeSettings], N]) -> N:
    settings = left.pop(node.id, None)
    return change(node, settings) if settings else node


def _grcn(node: GRCN, settings: NodeSettings) -> GRCN:
    values = _values(settings, node, {"policy", "release_after", "max_age", "max_hold"})
    flows = dict(settings.flows)
    changed = _flows(node.flows, flows)
    _refuse(flows, f"flow of {node.id}", [flow.name for flow in node.flows])
    return replace(node, flows=changed, **values)


def _rsrcn(node: RSRCN, settings: NodeSettings) -> RSRCN:
    values = _values(settings, node, {"policy", "threshold", "max_vel_limit"})
    return replace(node, vflows=_topics(node.id, node.vflows, settings), **values)


def _msrcn(node: MSRCN, settings: NodeSettings) -> MSRCN:
    values = _values(settings, node, {"policy"})
    aflows = _topics(node.id, node.aflows, settings)
    return replace(node, aflows=aflows, rules=tuple(_rules(node, settings.rules)), **values)


def _values(
    settings: NodeSettings, node: GRCN | RSRCN | MSRCN, allowed: Collection[str]
) -> dict[str, Any]:
    """Return what is set beside flows and rules; all of it must be for this kind of node."""
    names = [each.name for each in fields(settings) if each.name not in ("flows", "rules")]
    values = {name: getattr(settings, name) for name in names}
    given = {name: value for name, value in values.items() if value is not None}
    _refuse(given.keys() - allowed, f"setting of {node.id}", allowed)
    if settings.rules and not isinstance(node, MSRCN):
        raise MisfitError(f"{node.id} has no rules")
    return given


def _topics(
    id: str, topics: tuple[GuardedTopic, ...], settings: NodeSettings
) -> tuple[GuardedTopic, ...]:
    flows = dict(settings.flows)
    changed = tuple(replace(topic, flows=_flows(topic.flows, flows)) for topic in topics)
    known = [flow.name for topic in topics for flow in topic.flows]
    _refuse(flows, f"flow of {id}", known)
    return changed


def _flows(flows: tuple[Flow, ...], left: dict[str, FlowSettings]) -> tuple[Flow, ...]:
    return tuple(_flow(flow, left.pop(flow.name, FlowSettings())) for flow in flows)


def _flow(flow: Flow, settings: FlowSettings) -> Flow:
    return replace(
        flow,
        priority=flow.priority if settings.priority is None else settings.priority,
        block=flow.block if settings.block is None else settings.block,
        timeout=flow.timeout if settings.timeout is None else settings.timeout,
    )


def _rules(node: MSRCN, settings: Mapping[str, RuleSettings]) -> Iterator[Rule]:
    known = {rule.name for rule in node.rules}
    for rule in node.rules:
        own = settings.get(rule.name, RuleSettings())
        if own.selected is not False:
            yield replace(rule, block=own.block or rule.block, when=own.when or rule.when)
    for name, own in settings.items():
        if name not in known:
            yield from _own_rule(node, name, own)


def _own_rule(node: MSRCN, name: str, settings: RuleSettings) -> Iterator[Rule]:
    if not (settings.block and settings.when):
        raise MisfitError(f"{node.id} has no rule {name}, and a new one needs `when` and `block`")
    if settings.selected is not False:
        yield Rule(name=name, block=settings.block, when=settings.when)


def _refuse(left: Iterable[str], what: str, known: Iterable[str]) -> None:
    for name in (each[:_SHOWN] for each in left):
        raise MisfitError(f"no {what} is called {name}: {_near(name, sorted(known))}")


def _near(name: str, known: list[str]) -> str:
    near = get_close_matches(name, known, n=1)
    return f"did you mean {near[0]}?" if near else f"choose from {', '.join(known)}"

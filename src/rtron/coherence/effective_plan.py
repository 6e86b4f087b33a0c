"""A plan with settings in force, and what is wrong with the two together."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, TypeVar

from rtron.coherence.duration_bounds import bound_problems
from rtron.coherence.plan_checks import settable_problems
from rtron.errors import InputError, suggestion
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    Flow,
    FlowSettings,
    GuardedTopic,
    MissionRule,
    NodeSettings,
    Plan,
    RuleSettings,
    Settings,
)

N = TypeVar("N", GRCN, RSRCN, MSRCN)
_MAX_SHOWN = 80


class SettingsMismatchError(InputError):
    """Settings name what the plan does not have, or a guard cannot run the plan under them."""


@dataclass(frozen=True)
class EffectivePlan:
    """A plan under settings. Each part is computed once, when it is first needed.

    Overrides and the emergency stop change no policy, so they change no part of the plan.
    """

    base: Plan
    settings: Settings

    @cached_property
    def plan(self) -> Plan:
        """The plan in force, with the revision of the settings.

        SettingsMismatchError if the settings name what the plan does not have.
        """
        plan, remaining = self.base, dict(self.settings.nodes)
        grcn = tuple(_apply_to_node(node, remaining, _apply_to_grcn) for node in plan.grcn)
        rsrcn = plan.rsrcn and _apply_to_node(plan.rsrcn, remaining, _apply_to_rsrcn)
        msrcn = plan.msrcn and _apply_to_node(plan.msrcn, remaining, _apply_to_msrcn)
        _refuse_unknown(remaining, "coordination node", coordination_node_ids(plan))
        revision = self.settings.revision
        return replace(plan, grcn=grcn, rsrcn=rsrcn, msrcn=msrcn, revision=revision)

    def problems(self) -> Iterator[str]:
        """Yield what keeps a guard from running the plan under the settings.

        What is wrong with the plan itself, without settings, is not held against them.
        """
        yield from bound_problems(self.settings)
        for id in self.settings.overrides:
            if id not in _overridable_ids(self.base):
                yield f"{id[:_MAX_SHOWN]!r} cannot be overridden"
        found = dict.fromkeys(_messages(self.plan))
        known = set(_messages(self.base)) if found else set()
        yield from (message for message in found if message not in known)

    def check(self) -> Plan:
        """Return the plan in force; SettingsMismatchError if a guard cannot run it."""
        for problem in self.problems():
            raise SettingsMismatchError(problem)
        return self.plan


def compatible_settings(plan: Plan, settings: Settings) -> tuple[Settings, tuple[str, ...]]:
    """Return the settings without what the plan does not have, and what was left out."""
    mismatches = {
        id: _mismatch(plan, Settings(nodes={id: settings.nodes[id]})) for id in settings.nodes
    }
    nodes = {id: node for id, node in settings.nodes.items() if not mismatches[id]}
    overridable = _overridable_ids(plan)
    overrides = {id: each for id, each in settings.overrides.items() if id in overridable}
    dropped = [*filter(None, mismatches.values())]
    dropped += [f"{id} has an override" for id in settings.overrides if id not in overridable]
    return replace(settings, nodes=nodes, overrides=overrides), tuple(dropped)


def coordination_node_ids(plan: Plan) -> tuple[str, ...]:
    """Return the ids of the coordination nodes that have a policy, in the plan's order."""
    return tuple(node.id for node in (*plan.grcn, plan.rsrcn, plan.msrcn) if node)


def _overridable_ids(plan: Plan) -> set[str]:
    return {node.id for node in (plan.rsrcn, plan.msrcn) if node}


def _messages(plan: Plan) -> Iterator[str]:
    for part, _, message in settable_problems(plan):
        name = part.id if isinstance(part, (GRCN, RSRCN, MSRCN)) else ""
        name = f"rule {part.name}" if isinstance(part, MissionRule) else name
        yield f"{name}: {message}" if name else message


def _mismatch(plan: Plan, settings: Settings) -> str:
    try:
        EffectivePlan(plan, settings).plan  # noqa: B018 - computed to see whether it can be
    except SettingsMismatchError as error:
        return str(error)
    return ""


def _apply_to_node(
    node: N, remaining: dict[str, NodeSettings], apply: Callable[[N, NodeSettings], N]
) -> N:
    settings = remaining.pop(node.id, None)
    return apply(node, settings) if settings else node


def _apply_to_grcn(node: GRCN, settings: NodeSettings) -> GRCN:
    values = _set_values(settings, node, {"policy", "release_after", "max_age", "max_hold"})
    flows = dict(settings.flows)
    changed = _apply_to_flows(node.flows, flows)
    _refuse_unknown(flows, f"flow of {node.id}", [flow.name for flow in node.flows])
    return replace(node, flows=changed, **values)


def _apply_to_rsrcn(node: RSRCN, settings: NodeSettings) -> RSRCN:
    values = _set_values(settings, node, {"policy", "threshold", "max_vel_limit"})
    return replace(node, vflows=_apply_to_topics(node.id, node.vflows, settings), **values)


def _apply_to_msrcn(node: MSRCN, settings: NodeSettings) -> MSRCN:
    values = _set_values(settings, node, {"policy"})
    aflows = _apply_to_topics(node.id, node.aflows, settings)
    return replace(
        node, aflows=aflows, rules=tuple(_effective_rules(node, settings.rules)), **values
    )


def _set_values(
    settings: NodeSettings, node: GRCN | RSRCN | MSRCN, allowed: Collection[str]
) -> dict[str, Any]:
    """Return what is set beside flows and rules; all of it must be for this kind of node."""
    names = [each.name for each in fields(settings) if each.name not in ("flows", "rules")]
    values = {name: getattr(settings, name) for name in names}
    set_values = {name: value for name, value in values.items() if value is not None}
    _refuse_unknown(set_values.keys() - allowed, f"setting of {node.id}", allowed)
    if settings.rules and not isinstance(node, MSRCN):
        raise SettingsMismatchError(f"{node.id} has no rules")
    return set_values


def _apply_to_topics(
    id: str, topics: tuple[GuardedTopic, ...], settings: NodeSettings
) -> tuple[GuardedTopic, ...]:
    flows = dict(settings.flows)
    changed = tuple(replace(topic, flows=_apply_to_flows(topic.flows, flows)) for topic in topics)
    known = [flow.name for topic in topics for flow in topic.flows]
    _refuse_unknown(flows, f"flow of {id}", known)
    return changed


def _apply_to_flows(
    flows: tuple[Flow, ...], remaining: dict[str, FlowSettings]
) -> tuple[Flow, ...]:
    return tuple(_apply_to_flow(flow, remaining.pop(flow.name, FlowSettings())) for flow in flows)


def _apply_to_flow(flow: Flow, settings: FlowSettings) -> Flow:
    return replace(
        flow,
        priority=flow.priority if settings.priority is None else settings.priority,
        block=flow.block if settings.block is None else settings.block,
        timeout=flow.timeout if settings.timeout is None else settings.timeout,
    )


def _effective_rules(node: MSRCN, settings: Mapping[str, RuleSettings]) -> Iterator[MissionRule]:
    known = {rule.name for rule in node.rules}
    for rule in node.rules:
        rule_settings = settings.get(rule.name, RuleSettings())
        if rule_settings.selected is not False:
            yield replace(
                rule, block=rule_settings.block or rule.block, when=rule_settings.when or rule.when
            )
    for name, rule_settings in settings.items():
        if name not in known:
            yield from _user_rule(node, name, rule_settings)


def _user_rule(node: MSRCN, name: str, settings: RuleSettings) -> Iterator[MissionRule]:
    if not (settings.block and settings.when):
        raise SettingsMismatchError(
            f"{node.id} has no rule {name}, and a new one needs `when` and `block`"
        )
    if settings.selected is not False:
        yield MissionRule(name=name, block=settings.block, when=settings.when)


def _refuse_unknown(names: Iterable[str], what: str, known: Iterable[str]) -> None:
    for name in (each[:_MAX_SHOWN] for each in names):
        raise SettingsMismatchError(
            f"no {what} is called {name}: {suggestion(name, sorted(known))}"
        )

"""Who may do what to which kind of coordination node (paper, table of policies, Executor column).

Selecting a policy and setting a parameter are separate rights. What the plan calls `mandatory`
nobody can take away here: only the plan can.
"""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from rtron.coherence import EffectivePlan, coordination_node_ids
from rtron.coherence.msrcn import flows_by_name
from rtron.coherence.rsrcn import FRAME_RATE_POLICIES, VELOCITY_LIMIT_POLICIES, included_policies
from rtron.service.domain.principal import Right, UserRole
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    CoordinationKind,
    FlowSettings,
    MissionRule,
    NodeSettings,
    Plan,
    RuleSettings,
    Settings,
)

NodeRight = tuple[str, Right]
"""The id of a coordination node, and a right that is needed there."""

_GRCN, _RSRCN, _MSRCN = CoordinationKind.GRCN, CoordinationKind.RSRCN, CoordinationKind.MSRCN
RIGHTS_BY_ROLE: Mapping[UserRole, Mapping[CoordinationKind, frozenset[Right]]] = {
    UserRole.DEVELOPER: {
        _GRCN: frozenset(
            {
                Right.SELECT_POLICY,
                Right.SET_PRIORITY,
                Right.SET_BLOCK,
                Right.SET_TIMEOUT,
                Right.SET_DURATIONS,
            }
        ),
        _RSRCN: frozenset(
            {Right.SET_BLOCK, Right.SET_THRESHOLD, Right.SET_PRIORITY, Right.OVERRIDE}
        ),
        _MSRCN: frozenset({Right.OVERRIDE}),
    },
    UserRole.END_USER: {
        _RSRCN: frozenset({Right.SELECT_POLICY, Right.SET_MAX_VEL_LIMIT, Right.OVERRIDE}),
        _MSRCN: frozenset(
            {
                Right.SELECT_POLICY,
                Right.SET_BLOCK,
                Right.SELECT_RULES,
                Right.SET_RULES,
                Right.OVERRIDE,
            }
        ),
    },
}
"""What is not here is nobody's; the emergency stop is every role's."""

_NODE_RIGHTS: Mapping[str, Right] = {
    "policy": Right.SELECT_POLICY,
    "release_after": Right.SET_DURATIONS,
    "max_age": Right.SET_DURATIONS,
    "max_hold": Right.SET_DURATIONS,
    "threshold": Right.SET_THRESHOLD,
    "max_vel_limit": Right.SET_MAX_VEL_LIMIT,
}
_FLOW_RIGHTS: Mapping[str, Right] = {
    "priority": Right.SET_PRIORITY,
    "block": Right.SET_BLOCK,
    "timeout": Right.SET_TIMEOUT,
}
_RULE_RIGHTS: Mapping[str, Right] = {
    "selected": Right.SELECT_RULES,
    "block": Right.SET_RULES,
    "when": Right.SET_RULES,
}


def granted_rights(roles: Collection[UserRole], kind: CoordinationKind) -> frozenset[Right]:
    """Return what somebody with these roles may do to such coordination nodes."""
    granted = (RIGHTS_BY_ROLE.get(role, {}).get(kind, frozenset()) for role in roles)
    return frozenset[Right]().union(*granted)


def coordination_kinds(plan: Plan) -> dict[str, CoordinationKind]:
    """Return the kind of each coordination node that has a policy, by id."""
    kinds_by_id = {grcn.id: _GRCN for grcn in plan.grcn}
    kinds_by_id |= {plan.rsrcn.id: _RSRCN} if plan.rsrcn else {}
    return kinds_by_id | ({plan.msrcn.id: _MSRCN} if plan.msrcn else {})


def needed_rights(plan: Plan, before: Settings, after: Settings) -> set[NodeRight]:
    """Return the rights that it takes to make `after` of `before`; nodes as the plan has them.

    Overrides and the emergency stop are asked for on their own.
    """
    none = NodeSettings()
    return {
        (id, right)
        for id in coordination_node_ids(plan)
        for right in _needed_rights(before.nodes.get(id, none), after.nodes.get(id, none))
    }


def named_rights(plan: Plan, nodes: Mapping[str, Mapping[str, Any]]) -> set[NodeRight]:
    """Return the rights that a change takes for what it names, whether that differs or not.

    null for a whole flow or rule, or for all of them, names everything of it that a role may set.
    """
    kinds_by_id = coordination_kinds(plan)
    return {
        (id, right)
        for id, patch in nodes.items()
        for right in _named_rights(patch, granted_rights(tuple(UserRole), kinds_by_id[id]))
    }


def missing_rights(
    plan: Plan, roles: Collection[UserRole], needed: Collection[NodeRight]
) -> list[NodeRight]:
    """Return those of the needed rights that the roles do not give, in a steady order."""
    kinds_by_id = coordination_kinds(plan)
    return sorted(
        (id, right) for id, right in needed if right not in granted_rights(roles, kinds_by_id[id])
    )


def mandatory_violations(effective: EffectivePlan) -> Iterator[str]:
    """Yield what settings change although the plan makes it mandatory.

    SettingsMismatchError if the settings do not fit the plan.
    """
    plan, after = effective.base, effective.plan
    if plan.rsrcn and after.rsrcn:
        yield from _limit_violations(plan.rsrcn, after.rsrcn)
    if plan.msrcn and after.msrcn:
        for rule in plan.msrcn.rules:
            if rule.mandatory:
                yield from _rule_violations(rule, after.msrcn)


def _needed_rights(before: NodeSettings, after: NodeSettings) -> Iterator[Right]:
    yield from _changed_rights(_NODE_RIGHTS, before, after)
    for name in before.flows.keys() | after.flows.keys():
        yield from _changed_rights(
            _FLOW_RIGHTS,
            before.flows.get(name, FlowSettings()),
            after.flows.get(name, FlowSettings()),
        )
    for name in before.rules.keys() | after.rules.keys():
        yield from _changed_rights(
            _RULE_RIGHTS,
            before.rules.get(name, RuleSettings()),
            after.rules.get(name, RuleSettings()),
        )


def _named_rights(patch: Mapping[str, Any], grantable: frozenset[Right]) -> Iterator[Right]:
    yield from (right for key, right in _NODE_RIGHTS.items() if key in patch)
    for group, table in (("flows", _FLOW_RIGHTS), ("rules", _RULE_RIGHTS)):
        whole = grantable.intersection(table.values()) or frozenset(table.values())
        items = patch.get(group, {})
        for item in [None] if items is None else items.values():
            if item is None:
                yield from whole
            else:
                yield from (right for key, right in table.items() if key in item)


def _changed_rights(table: Mapping[str, Right], before: object, after: object) -> Iterator[Right]:
    return (right for key, right in table.items() if getattr(before, key) != getattr(after, key))


def _limit_violations(plan: RSRCN, after: RSRCN) -> Iterator[str]:
    if plan.mandatory is None:
        return
    if plan.mandatory not in included_policies(after.policy):
        yield f"{plan.mandatory} of {plan.id} is mandatory: {after.policy} would deselect it"
    prefix = f"{plan.mandatory} of {plan.id} is mandatory"
    if plan.mandatory in VELOCITY_LIMIT_POLICIES and _is_raised(
        plan.max_vel_limit, after.max_vel_limit
    ):
        yield f"{prefix}: max_vel_limit is at most {plan.max_vel_limit:g} m/s"
    if plan.mandatory in FRAME_RATE_POLICIES and _is_raised(plan.threshold, after.threshold):
        yield f"{prefix}: threshold is at most {plan.threshold:g} m/frame"


def _is_raised(most: float | None, after: float | None) -> bool:
    return most is not None and after is not None and after > most


def _rule_violations(rule: MissionRule, after: MSRCN) -> Iterator[str]:
    """Compare a mandatory rule with what is left: its condition stays, bits are only added."""
    current = next((each for each in after.rules if each.name == rule.name), None)
    prefix = f"the rule {rule.name} of {after.id} is mandatory"
    if current is None:
        yield f"{prefix}: it cannot be deselected"
    elif current.when != rule.when:
        yield f"{prefix}: its condition stays as the plan says"
    elif not _blocked_flows(rule, after) <= _blocked_flows(current, after):
        yield f"{prefix}: what it blocks stays blocked"


def _blocked_flows(rule: MissionRule, msrcn: MSRCN) -> frozenset[str]:
    flow_names = flows_by_name(msrcn)
    return frozenset[str]().union(*(flow_names.get(name, frozenset({name})) for name in rule.block))
